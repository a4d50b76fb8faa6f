// The table of keys: what is printed from it can be read, a reload goes by it, and no document
// lacks a key.
#include "firmware/config/settings_keys.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>

#include "firmware/config/configuration.h"
#include "firmware/config/reload.h"
#include "firmware/config/settings_text.h"
#include "support/scratch_folder.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

// print_settings() with every key in use. Keys stand behind a '#', words behind "# ".
std::vector<std::string> lines_in_use() {
  std::istringstream text(print_settings());
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with('#') && !line.starts_with("# ")) line.erase(0, 1);
    lines.push_back(line);
  }
  return lines;
}

// A file that is not there is left out, and so is what goes with it, and of two that would switch a
// transceiver the line; a surveyed device has a profile.
std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) {
    const bool is_of_secrets =
        line.starts_with("tls_") || line.starts_with("psk_") || line.starts_with("password_file");
    const bool is_left_out = line == R"(profiles = ["profiles.toml"])" ||
                             line == R"(rs485_line = "RS485_DE")" ||
                             (is_of_secrets && line.ends_with('"'));
    text += (is_left_out                     ? ""
             : line == R"(profile = "etcm")" ? R"(profile = "meter")"
             : line == R"(rs485 = "keep")"   ? R"(rs485 = "on")"
                                             : line) +
            "\n";
  }
  return text +
         "[[profile]]\nname = \"meter\"\n"
         "x = { register = 1, type = \"i16\" }\ny = { register = 2, type = \"i16\" }\n"
         "[[profile.reading]]\nname = \"level\"\nvalue = { register = 0, type = \"u16\" }\n";
}

// Where the first line of the key is.
std::size_t find_line(const std::vector<std::string>& lines, const KeyTable& table,
                      const Key& key) {
  std::string heading;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].starts_with('[')) heading = lines[i];
    if (heading == heading_of(table) && lines[i].starts_with(std::string(key.name) + " = ")) {
      return i;
    }
  }
  ADD_FAILURE() << path_of(table, key) << " is not printed";
  return 0;
}

// Another value than the one there is.
struct ChangeValue {
  Target target;

  void operator()(const DurationType& type) const { add(type.field, port::Duration(1ms)); }
  void operator()(const OptionalDurationType& type) const {
    type.field.set(target, port::Duration(7ms));
  }
  void operator()(const CountType& type) const {
    const std::uint32_t value = type.field.get(target);
    type.field.set(target, value < type.most ? value + 1 : value - 1);
  }
  void operator()(const ChoiceType& type) const {
    type.field.set(target, (type.field.get(target) + 1) % type.words.size());
  }
  void operator()(const BaudType& type) const { add(type.field, std::uint32_t{1}); }
  void operator()(const FlagType& type) const { type.field.set(target, !type.field.get(target)); }
  void operator()(const TextType& type) const { add(type.field, std::string("x")); }
  void operator()(const CalledType& type) const { add(type.field, std::string("x")); }
  void operator()(const NameType& type) const { add(type.field, std::string("x")); }
  void operator()(const PathType& type) const { add(type.field, std::string("x")); }
  void operator()(const AddressType& type) const {
    port::SocketAddress value = type.field.get(target);
    ++value.port;
    type.field.set(target, value);
  }
  void operator()(const OptionalAddressType& type) const {
    type.field.set(target, port::SocketAddress{.host = 0x0a000001, .port = 7});
  }
  void operator()(const EndpointType& type) const {
    port::Endpoint value = type.field.get(target);
    ++value.port;
    type.field.set(target, value);
  }
  void operator()(const PathsType& type) const { type.field.set(target, {"/elsewhere"}); }
  void operator()(const NetworksType& type) const { type.field.set(target, {port::everybody}); }
  void operator()(const HostNamesType& type) const { type.field.set(target, {"etcm.example"}); }
  void operator()(const UnitsType& type) const { type.field.set(target, {{200, 201}}); }
  void operator()(const BoardLineType& type) const {
    type.field.set(target, LineSettings{.name = "OTHER", .is_active_low = true});
  }
  void operator()(const OptionalCountType& type) const { type.field.set(target, 7); }
  void operator()(const DecimalType& type) const { type.field.set(target, 7); }
  void operator()(const ScaleType& type) const { add(type.field, std::int64_t{1}); }
  void operator()(const OriginType& type) const {
    type.field.set(target, {.x = type.field.get(target).x, .y = 7});
  }

  template <class Value>
  void add(const Access<Value>& field, const Value& more) const {
    field.set(target, static_cast<Value>(field.get(target) + more));
  }
};

class SettingsKeys : public testing::Test {
 protected:
  Settings read(const std::string& text) {
    mistakes_.clear();
    return read_settings(folder_.write("site.toml", text), mistakes_);
  }
  // What the key is read into, in settings of lines_in_use(). The printed bus of a serial port is
  // the second one.
  Target target_of(Settings& settings, const KeyTable& table, const Key& key) {
    const std::string_view name = table.name;
    if (name == "bus") return &settings.buses.at(key.bus == BusKind::rtu ? 1 : 0);
    if (name == "feature") return &settings.features.front();
    if (name == "bus.device") return &settings.buses.front().devices.front();
    if (name == "node") return &settings.nodes.front();
    return &settings;
  }
  template <class Work>
  static void for_each_key(const Work& work) {
    for (const KeyTable& table : key_tables()) {
      for (const Key& key : table.keys) work(table, key);
    }
  }
  bool has_mistake(const std::string& part) const {
    return std::any_of(mistakes_.begin(), mistakes_.end(), [&](const std::string& mistake) {
      return mistake.find(part) != std::string::npos;
    });
  }

  test::ScratchFolder folder_;
  std::vector<std::string> mistakes_;
};

TEST_F(SettingsKeys, TheOperatingGuideHasThem) {
  std::ifstream file(ETCM_OPERATING_GUIDE);
  ASSERT_TRUE(file) << ETCM_OPERATING_GUIDE;
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_NE(text.str().find("\n\n" + describe_settings() + "\n"), std::string::npos)
      << "put the output of `etcm-gateway --settings-table` into firmware/guide/settings.md";
}

TEST_F(SettingsKeys, HaveNamesAndWordsOfTheirOwn) {
  std::set<std::string> seen;
  for_each_key([&](const KeyTable& table, const Key& key) {
    const std::string path = path_of(table, key);
    EXPECT_TRUE(seen.insert(path).second) << path << " is there twice";
    const std::string text = key.text;
    EXPECT_FALSE(text.empty()) << path;
    EXPECT_EQ(text.find('|'), std::string::npos) << path << ": the guide is a table";
    EXPECT_FALSE(text.ends_with('.')) << path << ": who prints it ends the sentence";
    EXPECT_EQ(std::count(text.begin(), text.end(), '`') % 2, 0) << path;
  });
}

TEST_F(SettingsKeys, WhatIsPrintedIsGoodAsItStandsAndChangesNoDefault) {
  const std::string path = folder_.write("printed.toml", print_settings());
  Settings printed = read_configuration(path, nullptr, mistakes_);
  EXPECT_TRUE(mistakes_.empty()) << testing::PrintToString(mistakes_);
  Settings least =
      read("[mesh]\nvertices_max = 1000\n[[bus]]\ntcp = \"127.0.0.1:502\"\nunits = \"1-60\"\n");
  EXPECT_TRUE(take_over(printed, least).empty());
  EXPECT_TRUE(printed.site.path.empty());
  EXPECT_TRUE(printed.features.empty());
  for_each_key([&](const KeyTable& table, const Key& key) {
    if (table.kind == KeyTable::Kind::always) {
      EXPECT_TRUE(is_same_value(key.type, &printed, &least)) << path_of(table, key);
    }
  });
}

TEST_F(SettingsKeys, EveryLineThatIsPrintedIsGood) {
  const std::vector<std::string> lines = lines_in_use();
  // A device stands in the plane or in degrees.
  std::vector<std::string> good = lines;
  std::erase_if(good, [](const std::string& line) {
    return line.starts_with("longitude = ") || line.starts_with("latitude = ");
  });
  const Settings settings = read(joined(good));
  EXPECT_TRUE(mistakes_.empty()) << testing::PrintToString(mistakes_);
  EXPECT_EQ(settings.buses.size(), 2u);
  EXPECT_EQ(settings.buses.front().devices.size(), 1u);
  EXPECT_EQ(settings.nodes.size(), 1u);
  EXPECT_EQ(settings.features.size(), 1u);
  EXPECT_TRUE(settings.http && settings.files && settings.state && settings.mqtt);
  for_each_key([&](const KeyTable& table, const Key& key) {
    EXPECT_EQ(lines[find_line(lines, table, key)],
              std::string(key.name) + " = " + key.standard.toml);
  });
}

// No two rows lead to the same value, and none to nowhere.
TEST_F(SettingsKeys, EachLeadsToAValueOfItsOwn) {
  const std::string text = joined(lines_in_use());
  for_each_key([&](const KeyTable& table, const Key& key) {
    Settings settings = read(text);
    Settings same = settings;
    std::visit(ChangeValue{target_of(settings, table, key)}, key.type);
    for_each_key([&](const KeyTable& other_table, const Key& other) {
      const Target changed = target_of(settings, other_table, other);
      const Target old = target_of(same, other_table, other);
      EXPECT_EQ(is_same_value(other.type, old, changed), &other != &key)
          << path_of(table, key) << " changes " << path_of(other_table, other);
    });
  });
}

TEST_F(SettingsKeys, AReloadTakesEachOverOrNamesIt) {
  const std::string text = joined(lines_in_use());
  for_each_key([&](const KeyTable& table, const Key& key) {
    if (std::string_view(table.name) == "node") return;
    Settings current = read(text);
    Settings next = current;
    std::visit(ChangeValue{target_of(next, table, key)}, key.type);
    const std::vector<std::string> fixed = take_over(current, next);
    const bool is_taken = key.effect == Effect::at_once;
    EXPECT_EQ(is_same_value(key.type, target_of(current, table, key), target_of(next, table, key)),
              is_taken)
        << path_of(table, key);
    const bool is_of_a_bus = std::string_view(table.name).starts_with("bus");
    const std::string expected = path_of(table, key) + (is_of_a_bus ? " of '" : "");
    ASSERT_EQ(fixed.size(), is_taken ? 0u : 1u) << expected;
    if (is_taken) return;
    EXPECT_EQ(fixed[0].substr(0, expected.size()), expected);
  });
}

TEST_F(SettingsKeys, AReloadNamesDevicesThatAreOthersThanBefore) {
  for (const Key& key : key_table("node").keys) {
    // What people call it is apart from what it is.
    const bool is_name = std::string_view(key.name) == "name";
    EXPECT_EQ(key.effect, is_name ? Effect::at_once : Effect::restart) << key.name;
  }
  Settings current = read(joined(lines_in_use()));
  Settings next = current;
  next.buses[0].devices.push_back(next.buses[0].devices.front());
  next.nodes.front().address = 8;
  next.device_profiles.front().block_max = 7;
  const std::string profile = "[[profile]] name = \"" + next.device_profiles.front().name + "\"";
  EXPECT_EQ(take_over(current, next), (std::vector<std::string>{profile, "[[node]]"}));
}

// One bus that has to wait holds all of them up, so each that differs is named.
TEST_F(SettingsKeys, BusesAreTakenOverTogetherOrNotAtAll) {
  Settings current = read(joined(lines_in_use()));
  Settings next = current;
  next.buses[0].units = {{1, 9}};
  next.buses[1].timeout += 1ms;
  next.buses[0].devices.front().timeout = 1s;
  EXPECT_EQ(
      take_over(current, next),
      (std::vector<std::string>{"[[bus]] units of '" + current.buses[0].name + "'",
                                "[[bus]] timeout of '" + current.buses[1].name + "'",
                                "[[bus.device]] timeout of '" + current.buses[0].name + "'"}));
  EXPECT_NE(current.buses[1].timeout, next.buses[1].timeout);
  EXPECT_NE(current.buses[0].devices.front().timeout, 1s);
}

TEST_F(SettingsKeys, ATableThatComesOrGoesWaitsForTheRestart) {
  const Settings all = read(joined(lines_in_use()));
  const Settings least = read(print_settings());
  Settings current = least;
  current.buses = all.buses;
  const std::vector<std::string> fixed = take_over(current, all);
  for (const char* heading : {"[http]", "[files]", "[state]", "[mqtt]"}) {
    EXPECT_EQ(std::count(fixed.begin(), fixed.end(), heading), 1) << heading;
  }
  EXPECT_FALSE(current.http || current.files || current.state || current.mqtt);
}

TEST_F(SettingsKeys, AWrongValueOfEachIsNamedWithItsLineAndCure) {
  for_each_key([&](const KeyTable& table, const Key& key) {
    std::vector<std::string> lines = lines_in_use();
    const std::size_t at = find_line(lines, table, key);
    lines[at] = std::string(key.name) + " = [{}]";
    read(joined(lines));
    const std::string begin =
        folder_.path("site.toml") + ":" + std::to_string(at + 1) + ": '" + key.name + "' ";
    const auto found =
        std::find_if(mistakes_.begin(), mistakes_.end(),
                     [&](const std::string& mistake) { return mistake.starts_with(begin); });
    ASSERT_NE(found, mistakes_.end()) << path_of(table, key) << testing::PrintToString(mistakes_);
    EXPECT_NE(found->find("; "), std::string::npos) << *found;
  });
}

TEST_F(SettingsKeys, OneThatIsRequiredIsMissed) {
  for_each_key([&](const KeyTable& table, const Key& key) {
    if (key.standard.kind != Standard::Kind::required) return;
    std::vector<std::string> lines = lines_in_use();
    lines[find_line(lines, table, key)] = "";
    read(joined(lines));
    EXPECT_TRUE(has_mistake("'" + std::string(key.name) + "' is missing in " + heading_of(table) +
                            "; add it, such as " + key.name + " = " + key.standard.toml))
        << path_of(table, key) << testing::PrintToString(mistakes_);
  });
}

TEST_F(SettingsKeys, RangesHoldAtBothEnds) {
  for_each_key([&](const KeyTable& table, const Key& key) {
    const auto is_out = [&](const std::string& value) {
      std::vector<std::string> lines = lines_in_use();
      lines[find_line(lines, table, key)] = std::string(key.name) + " = " + value;
      read(joined(lines));
      return has_mistake("'" + std::string(key.name) + "' is ");
    };
    if (const auto* const count = std::get_if<CountType>(&key.type)) {
      EXPECT_TRUE(is_out(std::to_string(std::int64_t{count->least} - 1))) << path_of(table, key);
      EXPECT_FALSE(is_out(std::to_string(count->least))) << path_of(table, key);
      EXPECT_FALSE(is_out(std::to_string(count->most))) << path_of(table, key);
      EXPECT_TRUE(is_out(std::to_string(std::int64_t{count->most} + 1))) << path_of(table, key);
    }
    if (const auto* const duration = std::get_if<DurationType>(&key.type)) {
      const auto text = [](port::Duration value) {
        return "\"" + std::to_string(value / 1ms) + "ms\"";
      };
      EXPECT_TRUE(is_out(text(duration->least - 1ms))) << path_of(table, key);
      EXPECT_FALSE(is_out(text(duration->least))) << path_of(table, key);
      EXPECT_FALSE(is_out(text(24h))) << path_of(table, key);
      EXPECT_TRUE(is_out(text(24h + 1ms))) << path_of(table, key);
    }
  });
}

}  // namespace
}  // namespace etcm::firmware
