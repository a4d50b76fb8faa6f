#include "compare/systems/system.h"

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
    System{etcm_key, "ETCM (literal)", run_etcm},
    System{ours_key, "ours", run_default},
    System{"cgal", "CGAL conforming", run_cgal_conforming},
    System{constrained_key, "CGAL constrained", run_cgal_constrained, false},
};

constexpr std::array readings{
    System{"tsai-one", "Tsai, one crossing at a time", run_tsai_one},
    System{"lu-half", "Lu, evenly, a point for every two triangles crossed", run_lu_half},
    System{"lu-each", "Lu, evenly, a part for each triangle crossed", run_lu_each},
    System{"lu-spacing", "Lu, evenly, at the local spacing", run_lu_spacing},
    System{"lu-gap", "Lu, between the circles of the ends", run_lu_gap},
    System{"lu-gap-middle", "Lu, between the circles, else the middle", run_lu_gap_middle},
    System{"lu-foot", "Lu, foot of the nearest vertex", run_lu_foot},
    System{"lu-crossing", "Lu, the crossing nearest to the middle", run_lu_crossing},
    System{"lu-far", "Lu, furthest from all vertices", run_lu_far},
    System{"diametral", "Lu or Sapidis-Perucchio, empty diametral circles", run_diametral},
    System{"wei-first", "Wei, never finishing in the overlap", run_wei_first_circle},
    System{"etcm-stack", "ETCM, broken features on a stack", run_etcm_stack},
    System{"paper-policy", "our build with the policy `paper`", run_paper_policy},
};

std::vector<System> both() {
  std::vector<System> all(systems.begin(), systems.end());
  all.insert(all.end(), readings.begin(), readings.end());
  return all;
}

}  // namespace

std::span<const System> all_systems() noexcept { return systems; }
std::span<const System> other_readings() noexcept { return readings; }

std::string known_keys() {
  std::string known;
  for (const System& system : both()) {
    known += (known.empty() ? "" : ", ") + std::string(system.key);
  }
  return known;
}

std::vector<System> systems_named(std::span<const std::string> keys) {
  if (keys.empty()) return {systems.begin(), systems.end()};
  std::vector<System> all = both();
  for (const std::string& key : keys) {
    if (std::none_of(all.begin(), all.end(), [&](const System& s) { return s.key == key; })) {
      throw std::invalid_argument("no system '" + key + "'; there are " + known_keys());
    }
  }
  std::erase_if(all, [&](const System& system) {
    return std::find(keys.begin(), keys.end(), system.key) == keys.end();
  });
  return all;
}

}  // namespace etcm::compare
