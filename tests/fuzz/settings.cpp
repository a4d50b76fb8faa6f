// The settings of a gateway: any TOML beside a site, a profile and a plan that are sound. What is
// wrong is said in one line each; what is not is good for use.
#include <string>
#include <vector>

#include "firmware/config/configuration.h"
#include "firmware/config/reload.h"
#include "firmware/persist/saved_state.h"
#include "text_parts.h"

namespace etcm::fuzz {
namespace {

constexpr const char* site = R"({"type": "FeatureCollection", "features": [{"type": "Feature",
  "properties": {"name": "fence"}, "geometry": {"type": "LineString",
  "coordinates": [[0, 0], [100, 0], [100, 100]]}}]})";
constexpr const char* poly = "3 2 0 0\n1 0 0\n2 100 0\n3 0 100\n1 0\n1 1 2\n0\n";
constexpr const char* profile =
    "[[profile]]\nname = \"probe\"\n"
    "reading = [{ name = \"level\", unit = \"m\", register = 0, type = \"i16\" }]\n";

bool write_files() {
  scratch().write("site.geojson", site);
  scratch().write("site.poly", poly);
  scratch().write("probe.toml", profile);
  scratch().write("key", "a secret of some length\n");
  return true;
}

}  // namespace

void run(std::span<const std::uint8_t> bytes) {
  static const bool is_written = write_files();
  require(is_written, "files");
  const std::string path = scratch().write("gateway.toml", std::string(text_of(bytes)));
  std::vector<std::string> mistakes;
  firmware::Settings settings = firmware::read_configuration(path, nullptr, mistakes);
  for (const std::string& mistake : mistakes) {
    require(!mistake.empty() && mistake.find('\n') == mistake.npos, "a mistake is not one line");
  }
  if (!mistakes.empty()) return;
  require(firmware::saved_state_size_max(settings) > 0, "a state of no size");
  require(firmware::take_over(settings, settings).empty(), "settings differ from themselves");
}

}  // namespace etcm::fuzz
