// The example of the guide's first chapter, which the package has as a file.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "firmware/config/configuration.h"
#include "proj/proj_source.h"
#include "support/scratch_folder.h"

namespace etcm::firmware {
namespace {

const std::string firmware_folder = ETCM_FIRMWARE;

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// What stands in the guide's chapter as TOML, without the space before each line.
std::string example_of_guide() {
  std::istringstream guide(text_of(firmware_folder + "/guide/README.md"));
  const std::string before = "   ";
  std::string example;
  bool is_within = false;
  for (std::string line; std::getline(guide, line);) {
    if (line == before + "```toml") {
      is_within = true;
    } else if (is_within && line == before + "```") {
      break;
    } else if (is_within) {
      example += (line.starts_with(before) ? line.substr(before.size()) : line) + "\n";
    }
  }
  return example;
}

TEST(GuideExample, IsTheFileOfThePackage) {
  const std::string file = text_of(firmware_folder + "/examples/devices/gateway.toml");
  ASSERT_NE(file, "");
  EXPECT_EQ(example_of_guide(), file);
}

TEST(GuideExample, IsGoodAndWarnsOfNothing) {
  test::ScratchFolder folder;
  port::ProjSource proj;
  std::vector<std::string> mistakes;
  const Settings settings = read_configuration(
      folder.write("gateway.toml", "profiles = \"" + firmware_folder + "/profiles\"\n" +
                                       text_of(firmware_folder + "/examples/devices/gateway.toml")),
      &proj, mistakes);
  EXPECT_EQ(mistakes, std::vector<std::string>{});
  EXPECT_EQ(settings.warnings, std::vector<std::string>{});
  EXPECT_EQ(settings.buses.size(), 2u);
  EXPECT_EQ(settings.node_names.size(), 3u);
}

}  // namespace
}  // namespace etcm::firmware
