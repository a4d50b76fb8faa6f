#include "compare/system.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

namespace etcm::compare {
namespace {

constexpr std::array systems{
    System{"tsai", "Tsai", run_tsai},
    System{"lu", "Lu (reconstructed)", run_lu},
    System{"sapidis", "Sapidis-Perucchio", run_sapidis_perucchio},
    System{"wei", "Wei", run_wei},
    System{"etcm", "ETCM (paper)", run_etcm},
    System{ours_key, "ours", run_default},
    System{"cgal", "CGAL conforming", run_cgal_conforming},
    System{constrained_key, "CGAL constrained", run_cgal_constrained, false},
};

}  // namespace

std::span<const System> all_systems() noexcept { return systems; }

std::vector<System> systems_named(std::span<const std::string> keys) {
  std::string known;
  for (const System& system : systems)
    known += (known.empty() ? "" : ", ") + std::string(system.key);
  for (const std::string& key : keys) {
    const bool is_known = std::any_of(systems.begin(), systems.end(),
                                      [&key](const System& system) { return system.key == key; });
    if (!is_known) throw std::invalid_argument("no system '" + key + "'; there are " + known);
  }
  std::vector<System> chosen;
  for (const System& system : systems) {
    if (keys.empty() || std::find(keys.begin(), keys.end(), system.key) != keys.end()) {
      chosen.push_back(system);
    }
  }
  return chosen;
}

}  // namespace etcm::compare
