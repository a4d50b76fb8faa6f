// The guide's tables have the keys that the reader knows, and no others.
#include <fstream>
#include <set>
#include <sstream>

#include "device.h"

namespace etcm::firmware {
namespace {

// The rows of the guide's tables of keys.
std::map<std::string, std::set<std::string>> guide_keys() {
  std::ifstream guide(ETCM_PROFILE_GUIDE);
  std::map<std::string, std::set<std::string>> keys;
  std::string table;
  for (std::string line; std::getline(guide, line);) {
    if (line.starts_with("## ")) table = line.substr(3);
    if (!line.starts_with("| `")) continue;
    keys[table].insert(line.substr(3, line.find('`', 3) - 3));
  }
  return keys;
}

// What the reader says it knows where it meets a key that it does not know.
std::set<std::string> known_keys(const std::string& toml) {
  for (const std::string& mistake : read_profile_text(toml).mistakes) {
    const std::size_t at = mistake.find("known here: ");
    if (mistake.find("'qqqqqqqqqq' is unknown") == std::string::npos) continue;
    std::set<std::string> keys;
    std::istringstream list(mistake.substr(at + 12));
    for (std::string key; std::getline(list >> std::ws, key, ',');) keys.insert(key);
    return keys;
  }
  return {};
}

std::set<std::string> without(std::set<std::string> keys, const std::set<std::string>& others) {
  for (const std::string& other : others) keys.erase(other);
  return keys;
}

TEST(ProfileGuide, HasEveryKey) {
  const auto guide = guide_keys();
  const std::string head = "[[profile]]\nname = 'p'\n";
  const std::string strange = "qqqqqqqqqq = 1";
  const auto number =
      known_keys(head + "serial = { parts = [{ register = 0, " + strange + " }] }\n");
  EXPECT_EQ(number, guide.at("A number"));
  EXPECT_EQ(without(known_keys(head + "x = { register = 0, " + strange + " }\n"), number),
            guide.at("A field"));
  EXPECT_EQ(
      without(known_keys(head + "valid = { register = 0, equals = 1, " + strange + " }\n"), number),
      guide.at("A test"));
  EXPECT_EQ(known_keys(head + strange + "\n"), guide.at("A profile"));
  EXPECT_EQ(known_keys(head + "[[profile.reading]]\n" + strange + "\n"), guide.at("A reading"));
}

}  // namespace
}  // namespace etcm::firmware
