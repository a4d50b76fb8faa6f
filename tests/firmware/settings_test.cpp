// The configuration file: what is good, and what is said about what is not.
#include "firmware/config/settings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

class SettingsFile : public testing::Test {
 protected:
  SettingsFile() {
    folder_ =
        std::filesystem::path(testing::TempDir()) /
        ("settings_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    path_ = folder_ / "site.toml";
  }
  ~SettingsFile() override { std::filesystem::remove_all(folder_); }

  void write_beside(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  Settings read(const std::string& text) {
    std::ofstream(path_) << text;
    mistakes_.clear();
    return read_settings(path_, mistakes_);
  }
  // A mesh and these.
  Settings read_sound(const std::string& text) {
    const Settings settings = read("[mesh]\nvertices_max = 10\n" + text);
    EXPECT_TRUE(mistakes_.empty()) << mistakes_.front();
    return settings;
  }

  std::filesystem::path folder_;
  std::string path_;
  std::vector<std::string> mistakes_;
};

TEST_F(SettingsFile, TheLeastThatWorks) {
  const Settings settings = read_sound("[[bus]]\ntcp = \"127.0.0.1:502\"\nunits = \"1:3,9\"\n");
  EXPECT_EQ(settings.mesh.vertices_max, 10u);
  ASSERT_EQ(settings.buses.size(), 1u);
  EXPECT_EQ(settings.buses[0].name, "127.0.0.1:502");
  EXPECT_EQ(settings.buses[0].units.size(), 2u);
  EXPECT_EQ(settings.buses[0].timeout, settings.poll.timeout);
  EXPECT_EQ(to_string(settings.server.listen), "127.0.0.1:1502");
  EXPECT_FALSE(settings.files);
}

TEST_F(SettingsFile, ListensAtTheNameThatEveryMachineHas) {
  const Settings settings = read_sound(
      "[[bus]]\ntcp = \"127.0.0.1:502\"\nunits = \"1\"\n[http]\nlisten = \"localhost:8080\"\n");
  ASSERT_TRUE(settings.http);
  EXPECT_EQ(to_string(settings.http->listen), "127.0.0.1:8080");
  EXPECT_TRUE(settings.http->allow_place.ends_with("site.toml, line 6"))
      << settings.http->allow_place;
}

TEST_F(SettingsFile, EverySettingArrives) {
  const Settings settings = read(R"(
[site]
file = "coast.poly"
[mesh]
vertices_max = 10
features_max = 11
steiner_max = 5
work_max = 12
policy = "paper"
[poll]
interval = "250ms"
timeout = "30ms"
outstanding = 2
absent_interval = "1min"
stale_after = "3s"
leave_after = "9s"
dead_band = 4
[[bus]]
name = "yard"
tcp = "10.0.0.1:503"
units = "7"
timeout = "40ms"
outstanding = 1
[server]
listen = "0.0.0.0:1602"
allow = ["10.0.0.0/8", "192.168.1.7"]
clients_max = 3
[analysis]
radio_range = 400
sensing_range = 150

[files]
folder = "out"
name = "plan"
interval = "2s"
[[feature]]
from = 4000000000
to = 2
)");
  EXPECT_TRUE(mistakes_.empty()) << mistakes_.front();
  EXPECT_EQ(settings.site.path, folder_ / "coast.poly");
  EXPECT_EQ(settings.mesh.features_max, 11u);
  EXPECT_EQ(settings.mesh.steiner_max, 5u);
  EXPECT_EQ(settings.work_max, 12u);
  EXPECT_EQ(settings.mesh.policy, split_paper);
  EXPECT_EQ(settings.poll.interval, 250ms);
  EXPECT_EQ(settings.poll.timeout, 30ms);
  EXPECT_EQ(settings.poll.absent_interval, 1min);
  EXPECT_EQ(settings.poll.stale_after, 3s);
  EXPECT_EQ(settings.poll.leave_after, 9s);
  EXPECT_EQ(settings.poll.dead_band, 4u);
  EXPECT_EQ(settings.analysis.radio_range, 400u);
  EXPECT_EQ(settings.analysis.sensing_range, 150u);
  EXPECT_EQ(settings.buses[0].name, "yard");
  EXPECT_EQ(settings.buses[0].timeout, 40ms);
  EXPECT_EQ(settings.buses[0].outstanding_max, 1u);
  EXPECT_EQ(to_string(settings.server.listen), "0.0.0.0:1602");
  EXPECT_EQ(settings.server.clients_max, 3u);
  ASSERT_EQ(settings.server.allow.size(), 2u);
  EXPECT_EQ(to_string(settings.server.allow[0]), "10.0.0.0/8");
  EXPECT_EQ(settings.files->folder, folder_ / "out");
  EXPECT_EQ(settings.files->name, "plan");
  EXPECT_EQ(settings.files->interval, 2s);
  EXPECT_EQ(settings.features[0].from, Serial{4000000000});
  EXPECT_EQ(settings.features[0].source, path_ + ":36");
}

TEST_F(SettingsFile, EverySettingOfASerialBusArrives) {
  const Settings settings = read_sound(R"([[bus]]
rtu = "/dev/serial/by-path/pci-0"
units = "1-247"
baud = 9600
parity = "none"
stop_bits = 2
rs485 = "on"
rs485_rts = "low"
rs485_delay_before = "2ms"
rs485_delay_after = "100ms"
word_order = "CDAB"
timeout = "80ms"
quiet = "30ms"
[[bus]]
rtu = "/dev/ttyS1"
units = "1"
)");
  const BusSettings& bus = settings.buses[0];
  const auto& line = std::get<port::SerialLine>(bus.link);
  EXPECT_EQ(line.path, "/dev/serial/by-path/pci-0");
  EXPECT_EQ(bus.name, line.path);
  EXPECT_EQ(line.baud, 9600u);
  EXPECT_EQ(line.parity, port::Parity::none);
  EXPECT_EQ(line.stop_bits, 2);
  EXPECT_EQ(line.rs485.mode, port::Rs485Mode::on);
  EXPECT_EQ(line.rs485.rts_while_sending, port::RtsLevel::low);
  EXPECT_EQ(line.rs485.delay_before, 2ms);
  EXPECT_EQ(line.rs485.delay_after, 100ms);
  EXPECT_EQ(bus.word_order, WordOrder::cdab);
  EXPECT_EQ(bus.timeout, 80ms);
  EXPECT_EQ(bus.quiet, 30ms);
  EXPECT_EQ(bus.outstanding_max, 1u);
  const auto& usual = std::get<port::SerialLine>(settings.buses[1].link);
  EXPECT_EQ(usual.baud, 19200u);
  EXPECT_EQ(usual.rs485.mode, port::Rs485Mode::keep);
  EXPECT_EQ(usual.rs485.delay_before, std::nullopt);
  EXPECT_EQ(usual.parity, port::Parity::even);
  EXPECT_EQ(settings.buses[1].quiet, 50ms);
}

constexpr const char* float_at_7 =
    "\n[mesh]\nvertices_max = 10\n[[bus]]\ntcp = \"127.0.0.1:1500\"\n"
    "[[bus.device]]\nunits = \"7\"\nprofile = \"float\"\n";

// That the device's profile is not there is no mistake of its own then.
TEST_F(SettingsFile, ProfilesThatAreNowhereAreOneMistake) {
  std::filesystem::create_directory(folder_ / "here");
  for (const char* const profiles :
       {"\"nowhere.toml\"", "[\"nowhere\"]", "[\"here\", \"no/where\"]"}) {
    read("profiles = " + std::string(profiles) + float_at_7);
    ASSERT_EQ(mistakes_.size(), 1u) << profiles;
    EXPECT_TRUE(mistakes_[0].starts_with(path_ + ":1: there is no ")) << mistakes_[0];
    EXPECT_TRUE(
        mistakes_[0].ends_with("give a file with profiles, or a folder. Those of the "
                               "package need no 'profiles'"))
        << mistakes_[0];
    mistakes_.clear();
  }
}

TEST_F(SettingsFile, ProfilesThatAreWrongAreOneMistake) {
  write_beside("float.toml", "[[profile]]\nname = \"float\"\n[[profile.reading]]\nname = 5\n");
  read("profiles = \"float.toml\"" + std::string(float_at_7));
  ASSERT_FALSE(mistakes_.empty());
  for (const std::string& mistake : mistakes_) {
    EXPECT_NE(mistake.find("float.toml:"), std::string::npos) << mistake;
  }
}

TEST_F(SettingsFile, OfProfilesOfOneNameTheFirstCounts) {
  const auto profile = [](const std::string& name, int pause) {
    return "[[profile]]\nname = \"" + name + "\"\npause = \"" + std::to_string(pause) +
           "ms\"\n[[profile.reading]]\nname = \"level\"\nvalue = { register = 0 }\n";
  };
  std::filesystem::create_directory(folder_ / "more");
  write_beside("float.toml", profile("float", 1) + profile("other", 2));
  write_beside("more/a.toml", profile("float", 3) + profile("own", 4));
  write_beside("more/b.toml", profile("last", 5));
  const auto pause_of = [&](const Settings& settings, const char* name) {
    const Profile* const found = find_profile(settings, name);
    return found == nullptr ? -1ms
                            : std::chrono::duration_cast<std::chrono::milliseconds>(found->pause);
  };
  Settings settings =
      read("profiles = [\"float.toml\", \"more\"]" + std::string(float_at_7) + profile("own", 6));
  EXPECT_TRUE(mistakes_.empty()) << mistakes_.front();
  EXPECT_EQ(pause_of(settings, "float"), 1ms);
  EXPECT_EQ(pause_of(settings, "other"), 2ms);
  EXPECT_EQ(pause_of(settings, "own"), 6ms);
  EXPECT_EQ(pause_of(settings, "last"), 5ms);
  settings = read("profiles = [\"more\", \"float.toml\"]" + std::string(float_at_7));
  EXPECT_EQ(pause_of(settings, "float"), 3ms);
  EXPECT_EQ(settings.profiles.size(), 2u);
}

TEST_F(SettingsFile, ProfilesAreAPathOrAListOfThem) {
  for (const char* const profiles :
       {"5", "\"\"", "[1]", "[\"float.toml\", \"\"]", "[[]]", "true"}) {
    read("profiles = " + std::string(profiles) +
         "\n[mesh]\nvertices_max = 10\n[[bus]]\n"
         "tcp = \"127.0.0.1:1500\"\nunits = \"1\"\n");
    ASSERT_EQ(mistakes_.size(), 1u) << profiles;
    EXPECT_NE(mistakes_[0].find(":1: 'profiles' must be a path or a list of paths; write it as "
                                "profiles = [\"profiles.toml\"]"),
              std::string::npos)
        << mistakes_[0];
    mistakes_.clear();
  }
}

TEST_F(SettingsFile, DevicesAndSurveyedNodesAreRead) {
  const Settings settings = read_sound(R"([[profile]]
name = "meter"
pause = "30ms"
[[profile.reading]]
name = "level"
value = { register = 0, type = "u16" }
[[bus]]
tcp = "127.0.0.1:1500"
name = "yard"
units = "1-3"
[[bus.device]]
units = "3,7"
profile = "meter"
timeout = "600ms"
[[node]]
unit = 7
serial = 42
x = "1.5"
y = -2
)");
  const BusSettings& bus = settings.buses[0];
  EXPECT_EQ(bus.units, (std::vector<UnitRange>{{1, 3}, {7, 7}}));
  EXPECT_EQ(device_at(bus, ModbusAddress{1}), nullptr);
  ASSERT_NE(device_at(bus, ModbusAddress{7}), nullptr);
  EXPECT_EQ(device_at(bus, ModbusAddress{7})->profile, "meter");
  EXPECT_EQ(device_at(bus, ModbusAddress{7})->pause, 30ms) << "that of the profile";
  EXPECT_NE(find_profile(settings, "meter"), nullptr);
  ASSERT_EQ(settings.nodes.size(), 1u);
  EXPECT_EQ(settings.nodes[0].bus, "yard");
  EXPECT_EQ(settings.nodes[0].serial, 42u);
  EXPECT_EQ(settings.nodes[0].x, 1'500'000'000);
  EXPECT_EQ(settings.nodes[0].y, -2'000'000'000);
}

TEST_F(SettingsFile, SomeUnitsMayTakeLonger) {
  const Settings settings = read_sound(R"([[bus]]
tcp = "127.0.0.1:1500"
units = "1-20"
timeout = "80ms"
[[bus.device]]
units = "7,12-14"
timeout = "600ms"
[[bus.device]]
units = "20"
timeout = "20ms"
[[bus]]
tcp = "127.0.0.1:1501"
units = "7"
)");
  const BusSettings& bus = settings.buses[0];
  EXPECT_EQ(timeout_of(bus, ModbusAddress{7}), 600ms);
  EXPECT_EQ(timeout_of(bus, ModbusAddress{8}), 80ms);
  EXPECT_EQ(timeout_of(bus, ModbusAddress{13}), 600ms);
  EXPECT_EQ(timeout_of(bus, ModbusAddress{20}), 20ms);
  EXPECT_EQ(timeout_of(settings.buses[1], ModbusAddress{7}), settings.poll.timeout);
}

TEST_F(SettingsFile, EveryLineOfTheBoardArrives) {
  const Settings settings = read(R"(
[mesh]
vertices_max = 10
[gpio]
alert = "!ALERT"
join_button = "gpiochip0:3"
status_led = "LED"
watchdog = "WDI"
debounce = "5ms"
[[bus]]
rtu = "/dev/ttyS1"
units = "1,247"
rs485_line = "DE"
)");
  EXPECT_TRUE(mistakes_.empty()) << mistakes_.front();
  EXPECT_EQ(settings.gpio.alert->name, "ALERT");
  EXPECT_TRUE(settings.gpio.alert->is_active_low);
  EXPECT_EQ(settings.gpio.join_button->name, "gpiochip0:3");
  EXPECT_FALSE(settings.gpio.join_button->is_active_low);
  EXPECT_EQ(settings.gpio.status_led->name, "LED");
  EXPECT_EQ(settings.gpio.watchdog->name, "WDI");
  EXPECT_EQ(settings.gpio.debounce, 5ms);
  EXPECT_EQ(settings.buses[0].send_enable->name, "DE");
}

struct Mistake {
  const char* name;
  std::string text;  // after three good lines
  int line;
  const char* what;
  const char* cure;
};

std::string serial(const std::string& lines) {
  return "[[bus]]\nrtu = \"/dev/ttyS0\"\nunits = \"1\"\n" + lines;
}

std::string bus(const std::string& lines) { return "[[bus]]\ntcp = \"127.0.0.1:502\"\n" + lines; }

// A device that has a profile, in lines 4 to 14.
std::string meter(const std::string& lines) {
  return "[[profile]]\nname = \"meter\"\n[[profile.reading]]\nname = \"level\"\n"
         "value = { register = 0, type = \"u16\" }\n" +
         serial("[[bus.device]]\nunits = \"1\"\nprofile = \"meter\"\n") + lines;
}

class SettingsMistake : public SettingsFile, public testing::WithParamInterface<Mistake> {};

TEST_P(SettingsMistake, IsNamedWithItsLineAndCure) {
  read("# a site\n[mesh]\nvertices_max = 10\n" + GetParam().text);
  ASSERT_EQ(mistakes_.size(), 1u) << testing::PrintToString(mistakes_);
  const std::string begin = path_ + ":" + std::to_string(GetParam().line) + ": ";
  EXPECT_EQ(mistakes_[0].substr(0, begin.size()), begin);
  EXPECT_NE(mistakes_[0].find(GetParam().what), std::string::npos) << mistakes_[0];
  EXPECT_NE(mistakes_[0].find(GetParam().cure), std::string::npos) << mistakes_[0];
}

INSTANTIATE_TEST_SUITE_P(
    Rows, SettingsMistake,
    testing::Values(
        Mistake{"syntax", bus("units = \"1\"\n") + "x = = 1\n", 7, "", "correct the TOML"},
        Mistake{"misspelt_key", "vertexes = 1\n" + bus("units = \"1\"\n"), 4,
                "'vertexes' is unknown in [mesh]", "known here: features_max"},
        Mistake{"bus_is_no_list", "[bus]\n", 4, "'bus' must be a list", "[[bus]]"},
        Mistake{"no_units", bus(""), 4, "'units' is missing", "units = \"1-60\""},
        Mistake{"bad_units", bus("units = \"1-300\"\n"), 6, "'units' must list", "\"1-60\""},
        Mistake{"no_port", "[[bus]]\ntcp = \"host\"\nunits = \"1\"\n", 5,
                "'tcp' is neither an address nor a name with a port", "plc.example:502"},
        Mistake{"ipv6_without_brackets", "[[bus]]\ntcp = \"2001:db8::1:502\"\nunits = \"1\"\n", 5,
                "'tcp' is neither an address nor a name with a port", "[2001:db8::1]:502"},
        Mistake{"listens_at_a_name",
                bus("units = \"1\"\n") + "[server]\nlisten = \"plc.example:502\"\n", 8,
                "'listen' has the name 'plc.example'", "[::1]:502"},
        Mistake{"one_unit_behind_one_name",
                "[[bus]]\ntcp = \"PLC.example:502\"\nunits = \"1-9\"\n"
                "[[bus]]\ntcp = \"plc.example:502\"\nunits = \"4\"\nname = \"b\"\n",
                7, "unit 4 at plc.example:502 is asked by another [[bus]]", "take it out of one"},
        Mistake{"page_and_server_at_every_address",
                bus("units = \"1\"\n") +
                    "[server]\nlisten = \"[::]:8080\"\n[http]\nlisten = \"127.0.0.1:8080\"\n",
                9, "would both listen on port 8080", "give one another"},
        Mistake{"number_as_text", "features_max = \"9\"\n" + bus("units = \"1\"\n"), 4,
                "is a number in quotes", "write it as features_max = 9"},
        Mistake{"word_for_a_number", "features_max = \"many\"\n" + bus("units = \"1\"\n"), 4,
                "out of range", "whole number from 0"},
        Mistake{"baud_as_text", serial("baud = \"19200\"\n"), 7, "is a number in quotes",
                "write it as baud = 19200"},
        Mistake{"port_alone", bus("units = \"1\"\n") + "[http]\nlisten = \"8081\"\n", 8,
                "'listen' is no address", "\"127.0.0.1:8081\""},
        Mistake{"host_alone", bus("units = \"1\"\n") + "[http]\nlisten = \"here\"\n", 8,
                "'listen' is no address", "\"127.0.0.1:8080\""},
        Mistake{"quote_that_is_missing", bus("units = \"1\n") + "[http]\n", 6,
                "a text has no end in its line", "put a quote"},
        Mistake{"negative", "features_max = -1\n" + bus("units = \"1\"\n"), 4, "out of range",
                "whole number from 0"},
        Mistake{"bad_policy", "policy = \"fast\"\n" + bus("units = \"1\"\n"), 4,
                "policy 'fast' is unknown", "\"paper\""},
        Mistake{"no_unit_of_time", "[poll]\ninterval = \"500\"\n" + bus("units = \"1\"\n"), 5,
                "is no duration", "\"500ms\""},
        Mistake{"duration_as_number", "[poll]\ninterval = 500\n" + bus("units = \"1\"\n"), 5,
                "is no duration", "\"500ms\""},
        Mistake{"zero_duration", "[poll]\ntimeout = \"0ms\"\n" + bus("units = \"1\"\n"), 5,
                "too short", "at least \"1ms\""},
        Mistake{"long_duration", "[poll]\ntimeout = \"1441min\"\n" + bus("units = \"1\"\n"), 5,
                "longer than a day", "give less"},
        Mistake{"leaves_too_soon",
                "[poll]\ninterval = \"2s\"\nleave_after = \"2s\"\n" + bus("units = \"1\"\n"), 6,
                "leave_after is not longer than interval", "several times"},
        Mistake{"feature_to_itself", bus("units = \"1\"\n") + "[[feature]]\nfrom = 5\nto = 5\n", 7,
                "from node 5 to itself", "two different serials"},
        Mistake{"two_buses_of_one_name", bus("units = \"1\"\n") + bus("units = \"2\"\n"), 7,
                "two buses are named", "another 'name'"},
        Mistake{"one_unit_on_two_buses", bus("units = \"1-9\"\n") + bus("units = \"4\"\n"), 7,
                "unit 4 at 127.0.0.1:502 is asked by another [[bus]]", "take it out of one"},
        Mistake{"one_line_of_two_buses", serial("") + serial("name = \"b\"\n"), 7,
                "another [[bus]] has the serial port", "put the units of both into one"},
        Mistake{"page_on_the_port_of_the_server",
                bus("units = \"1\"\n") +
                    "[server]\nlisten = \"0.0.0.0:8080\"\n[http]\nlisten = \"127.0.0.1:8080\"\n",
                9, "would both listen on port 8080", "give one another"},
        Mistake{"text_without_quotes", "[[bus]]\ntcp = 127.0.0.1:502\nunits = \"1\"\n", 5, "",
                "texts stand in quotes"},
        Mistake{"no_link", "[[bus]]\nunits = \"1\"\n", 4, "neither 'tcp' nor 'rtu'", "add one"},
        Mistake{"two_links", serial("tcp = \"1.2.3.4:5\"\n"), 7, "both 'tcp' and 'rtu'",
                "make it two buses"},
        Mistake{"slow_baud", serial("baud = 49\n"), 7, "is no speed", "9600, 19200"},
        Mistake{"fast_baud", serial("baud = 4000001\n"), 7, "is no speed", "from 50 to 4000000"},
        Mistake{"delay_without_rs485", serial("rs485_delay_before = \"1ms\"\n"), 7,
                "'rs485_delay_before' says how the driver switches", "add rs485 = \"on\""},
        Mistake{"rts_without_rs485", serial("rs485 = \"off\"\nrs485_rts = \"low\"\n"), 8,
                "'rs485_rts' says how the driver switches", "take it out"},
        Mistake{"long_delay", serial("rs485 = \"on\"\nrs485_delay_after = \"101ms\"\n"), 8,
                "'rs485_delay_after' is too long", "at most \"100ms\""},
        Mistake{"bad_parity", serial("parity = \"mark\"\n"), 7, "parity 'mark' is unknown",
                "\"even\""},
        Mistake{"three_stop_bits", serial("stop_bits = 3\n"), 7, "out of range", "from 1 to 2"},
        Mistake{"bad_word_order", serial("word_order = \"little\"\n"), 7,
                "word_order 'little' is unknown", "\"CDAB\""},
        Mistake{"outstanding_on_a_line", serial("outstanding = 4\n"), 7,
                "'outstanding' is unknown in [[bus]]", "known here: assign, baud"},
        Mistake{"device_without_units", serial("") + "[[bus.device]]\ntimeout = \"1s\"\n", 7,
                "'units' is missing in [[bus.device]]", "add it"},
        Mistake{"device_of_no_profile",
                serial("") + "[[bus.device]]\nunits = \"1\"\nprofile = \"none\"\n", 9,
                "there is no profile 'none'", "take one of etcm"},
        Mistake{"speed_of_a_node",
                serial("") + "[[bus.device]]\nunits = \"1\"\nspeed_max = \"3\"\n", 9,
                "'speed_max' of nodes of our own", "take it out"},
        Mistake{"speed_of_what_stands", meter("speed_max = \"3\"\n"), 15,
                "'speed_max' is about the position, and profile 'meter' tells none", "take it out"},
        Mistake{"speed_of_nothing",
                "[[profile]]\nname = \"a\"\nx = { register = 0 }\ny = { register = 1 }\n" +
                    serial("[[bus.device]]\nunits = \"1\"\nprofile = \"a\"\nspeed_max = 0\n"),
                14, "'speed_max' must be above 0", "write it as"},
        Mistake{"node_that_tells_itself", serial("") + "[[node]]\nunit = 1\nserial = 5\n", 8,
                "tells its serial and where it stands itself", "give it another profile"},
        Mistake{"node_of_no_bus", serial("") + "[[node]]\nbus = \"x\"\nunit = 1\n", 8,
                "no [[bus]] is named 'x'", "correct one of the names"},
        Mistake{"node_at_no_unit", serial("") + "[[node]]\nunit = 200\n", 8, "is not asked",
                "add it to the units"},
        Mistake{"node_with_half_a_place", meter("") + "[[node]]\nunit = 1\nx = 5\n", 17,
                "'x' and 'y' go together", "add 'y'"},
        Mistake{"node_in_the_plane_and_half_in_degrees",
                meter("") + "[[node]]\nunit = 1\nx = 5\ny = 6\nlatitude = \"63.4\"\n", 19,
                "'longitude' and 'latitude' go together", "or take the other out"},
        Mistake{"profile_of_nodes",
                "[[profile]]\nname = \"etcm\"\nx = { register = 0 }\ny = { register = 1 }\n" +
                    serial(""),
                5, "'etcm' is the profile of nodes", "take another name"},
        Mistake{"two_profiles_of_a_name",
                "[[profile]]\nname = \"a\"\nx = { register = 0 }\ny = { register = 1 }\n"
                "[[profile]]\nname = \"a\"\nx = { register = 0 }\ny = { register = 1 }\n" +
                    serial(""),
                9, "another [[profile]] is named 'a'", "another name"},
        Mistake{"node_too_far_away", meter("") + "[[node]]\nunit = 1\nx = 0\ny = \"10000000000\"\n",
                18, "'y' must be a decimal from -1000000000 to", "in quotes"},
        Mistake{"two_devices_at_one_unit",
                serial("") + "[[bus.device]]\nunits = \"1-3\"\n[[bus.device]]\nunits = \"3\"\n", 10,
                "unit 3 is in the [[bus.device]] of ", "take it out of one"},
        Mistake{"device_as_table", serial("") + "[bus.device]\nunits = \"1\"\n", 7,
                "must be a list of tables", "[[bus.device]]"},
        Mistake{"bad_scan", bus("scan = \"0-9\"\n"), 6, "'scan' must list", "\"1-60\""},
        Mistake{"default_unit_given", bus("assign = \"240-247\"\n"), 6, "247 is where new nodes",
                "take it out"},
        Mistake{"no_budget", bus("units = \"1\"\nscan_budget = \"0ms\"\n"), 7, "too short", "1ms"},
        Mistake{"write_back_as_text", "[write_back]\nenabled = \"yes\"\n" + bus("units = \"1\"\n"),
                5, "'enabled'", "true"},
        Mistake{"alert_for_nobody", "[gpio]\nalert = \"A\"\n" + serial(""), 4, "unit 247",
                "add 247"},
        Mistake{"two_switch", serial("rs485 = \"on\"\nrs485_line = \"DE\"\n"), 8,
                "both the driver and a line", "take rs485 or"},
        Mistake{"line_as_number", "[gpio]\nstatus_led = 4\n" + serial(""), 5, "must be a text",
                "status_led = \"STATUS_LED\""},
        Mistake{"baud_of_a_socket", bus("units = \"1\"\nbaud = 9600\n"), 7,
                "'baud' is unknown in [[bus]]", "known here"},
        Mistake{"nearly_a_key", "[poll]\nintervall = \"1s\"\n" + bus("units = \"1\"\n"), 5,
                "'intervall' is unknown in [poll]", "did you mean 'interval'?"},
        Mistake{"bad_network",
                bus("units = \"1\"\n") +
                    "[server]\nallow = [\"10.0.0.0/8\",\n  \"office\", \"127.0.0.1\"]\n",
                9, "'allow' has \"office\", which is no network", "\"127.0.0.0/8\""},
        Mistake{"network_as_number", bus("units = \"1\"\n") + "[server]\nallow = [10]\n", 8,
                "'allow' has what is no text", "\"127.0.0.0/8\""},
        Mistake{"one_network", bus("units = \"1\"\n") + "[server]\nallow = \"10.0.0.0/8\"\n", 8,
                "'allow' must list networks", "\"127.0.0.0/8\""},
        Mistake{"page_at_a_name",
                bus("units = \"1\"\n") + "[http]\nlisten = \"gate.example:8080\"\n", 8,
                "has the name 'gate.example'; it takes addresses of this machine, and of names "
                "localhost alone",
                "\"[::]:8080\" for all of its addresses"},
        Mistake{"bus_of_two_lines", bus("units = \"1\"\nname = \"yard\\nwest\"\n"), 7,
                "'name' must be a text of 1 to", "name = \"yard\""},
        Mistake{"files_without_folder", bus("units = \"1\"\n") + "[files]\n", 7,
                "'folder' is missing in [files]", "add it"},
        Mistake{"files_beside_their_folder",
                bus("units = \"1\"\n") + "[files]\nfolder = \"a\"\nname = \"../b\"\n", 9,
                "'name' is that of files in 'folder'", "give the path in 'folder'"},
        Mistake{"socket_of_a_long_path",
                bus("units = \"1\"\n") + "[control]\nsocket = \"/" + std::string(107, 'x') + "\"\n",
                8, "'socket' is a path of 108 bytes, and no more than 107", "give a shorter one"}),
    [](const auto& row) { return std::string(row.param.name); });

TEST_F(SettingsFile, OneThatHasNoEndIsNotReadForEver) {
  mistakes_.clear();
  read_settings("/dev/zero", mistakes_);
  ASSERT_EQ(mistakes_.size(), 1u);
  EXPECT_NE(mistakes_[0].find("/dev/zero: has more than 16777216 bytes"), std::string::npos)
      << mistakes_[0];
}

TEST_F(SettingsFile, AllMistakesComeAtOnceFromTheTop) {
  read("[poll]\nx = 1\ninterval = 1\n[mesh]\nvertices_max = 0\n");
  ASSERT_EQ(mistakes_.size(), 3u) << testing::PrintToString(mistakes_);
  EXPECT_NE(mistakes_[0].find(":2: 'x' is unknown"), std::string::npos) << mistakes_[0];
  EXPECT_NE(mistakes_[2].find(":5: 'vertices_max'"), std::string::npos) << mistakes_[2];
}

TEST_F(SettingsFile, WhatIsNoTomlIsNamedWithItsLine) {
  for (const auto& [text, line] : {std::pair{"[mesh]\nvertices_max = \n", 2},
                                   {"[mesh]\nvertices_max = 1\nvertices_max = 2\n", 3},
                                   {"[mesh]\n[poll]\n[mesh]\n", 3},
                                   {"[mesh\n", 1}}) {
    read(text);
    ASSERT_EQ(mistakes_.size(), 1u) << text;
    EXPECT_TRUE(mistakes_[0].starts_with(path_ + ":" + std::to_string(line) + ": "))
        << mistakes_[0];
    EXPECT_NE(mistakes_[0].find("; correct the TOML there"), std::string::npos);
  }
}

TEST_F(SettingsFile, AMistakeIsOneLineWhateverStandsInTheFile) {
  for (const char* const text :
       {"units = t\n]", "\"a\\nb\" = 1\n", "[mesh]\nvertices_max = 9\npolicy = \"pa\\u001bper\"\n",
        "[mesh]\nvertices_max = 9\n[[bus]]\ntcp = \"127.0.0.1:502\"\nunits = \"1-9\"\n"
        "[[bus.device]]\nprofile = \"no\\nsuch\"\nunits = \"1\"\n"}) {
    read(text);
    ASSERT_FALSE(mistakes_.empty()) << text;
    for (const std::string& mistake : mistakes_) {
      EXPECT_TRUE(mistake.starts_with(path_ + ":")) << mistake;
      EXPECT_TRUE(std::all_of(mistake.begin(), mistake.end(), [](char c) {
        return static_cast<unsigned char>(c) >= ' ' && c != '\x7f';
      })) << mistake;
    }
  }
}

TEST_F(SettingsFile, AFileThatIsNotThereIsAMistake) {
  read_settings(folder_ / "nowhere.toml", mistakes_);
  ASSERT_EQ(mistakes_.size(), 1u);
  EXPECT_NE(mistakes_[0].find("nowhere.toml"), std::string::npos);
  EXPECT_NE(mistakes_[0].find("; check the path"), std::string::npos);
}

TEST_F(SettingsFile, WhatIsNoUtf8IsAMistakeWithItsLine) {
  for (const char* const name : {"\xff", "yard \xe2\x82", "\xc0\xaf", "\xed\xa0\x80"}) {
    read("[mesh]\nvertices_max = 9\n[[bus]]\ntcp = \"127.0.0.1:502\"\nname = \"" +
         std::string(name) + "\"\nunits = \"1\"\n");
    ASSERT_EQ(mistakes_.size(), 1u) << name;
    EXPECT_TRUE(mistakes_[0].starts_with(path_ + ":5: ")) << mistakes_[0];
    EXPECT_NE(mistakes_[0].find("invalid utf-8"), std::string::npos) << mistakes_[0];
  }
}

}  // namespace
}  // namespace etcm::firmware
