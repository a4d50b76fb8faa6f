// What a person has drawn of a site: GeoJSON ('g'), a .poly ('p'), or a plan and its world file
// ('w'). The second byte chooses what the settings say of it.
#include <string>
#include <vector>

#include "firmware/config/configuration.h"
#include "text_parts.h"

namespace etcm::fuzz {
namespace {

constexpr const char* of_mesh =
    "\n[mesh]\nvertices_max = 500\nfeatures_max = 100\n"
    "[[bus]]\nname = \"yard\"\ntcp = \"127.0.0.1:502\"\nunits = \"1:9\"\n";

std::string settings_of(std::uint8_t kind, std::uint8_t choice) {
  std::string text = "[site]\n";
  if (kind == 'w') {
    text += "plan = \"plan.png\"\n";
    if (choice % 4 == 1) text += "plan_in = \"plane\"\n";
    if (choice % 4 == 2) text += "plan_in = \"degrees\"\n";
    return text + of_mesh;
  }
  text += kind == 'p' ? "file = \"site.poly\"\n" : "file = \"site.geojson\"\n";
  if (choice % 2 == 1) text += "round = true\n";
  if (choice % 4 >= 2) text += "unit = 0.01\n";
  if (choice % 8 >= 4) text += "origin = [10, -20.5]\n";
  if (choice % 16 >= 8) text += "[analysis]\nsensing_range = 10\n";
  return text + of_mesh;
}

}  // namespace

void run(std::span<const std::uint8_t> bytes) {
  Input input(bytes);
  const std::uint8_t kind = input.byte(), choice = input.byte();
  std::string_view text = text_of(input.rest());
  const std::string path = scratch().write("gateway.toml", settings_of(kind, choice));
  if (kind == 'w') {
    scratch().write("plan.pgw", take_part(text));
    scratch().write("plan.png", std::string(text));
  } else {
    scratch().write(kind == 'p' ? "site.poly" : "site.geojson", take_part(text));
  }
  if (kind == 'p') scratch().write("site.node", std::string(text));
  std::vector<std::string> mistakes;
  const firmware::Settings settings = firmware::read_configuration(path, nullptr, mistakes);
  for (const std::string& mistake : mistakes) {
    require(!mistake.empty() && mistake.find('\n') == mistake.npos, "a mistake is not one line");
  }
  if (!mistakes.empty()) return;
  require(settings.features.size() <= 100 && settings.anchors.size() <= 500, "it has no room");
}

}  // namespace etcm::fuzz
