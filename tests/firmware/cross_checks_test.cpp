// What is wrong between the settings of several tables: each with its line and a cure.
#include "firmware/config/cross_checks.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "firmware/config/configuration.h"
#include "firmware/config/settings.h"
#include "support/scratch_folder.h"

namespace etcm::firmware {
namespace {

struct Row {
  const char* name;
  std::string text;  // after three good lines
  int line;
  const char* what;
  const char* cure;
};

std::string serial(const std::string& lines) {
  return "[[bus]]\nrtu = \"/dev/ttyS0\"\nunits = \"1\"\n" + lines;
}

std::string bus(const std::string& address, const std::string& lines = "units = \"1\"\n") {
  return "[[bus]]\ntcp = \"" + address + "\"\n" + lines;
}

class CrossChecks : public testing::Test {
 protected:
  Settings read(const std::string& text) {
    path_ = folder_.write("site.toml", "# a site\n[mesh]\nvertices_max = 10\n" + text);
    mistakes_.clear();
    return read_settings(path_, mistakes_);
  }
  void expect_only(const std::vector<std::string>& lines, const Row& row) const {
    ASSERT_EQ(lines.size(), 1u) << testing::PrintToString(lines);
    const std::string begin = path_ + ":" + std::to_string(row.line) + ": ";
    EXPECT_EQ(lines[0].substr(0, begin.size()), begin);
    EXPECT_NE(lines[0].find(row.what), std::string::npos) << lines[0];
    EXPECT_NE(lines[0].find(std::string("; ") + row.cure), std::string::npos) << lines[0];
  }

  test::ScratchFolder folder_;
  std::string path_;
  std::vector<std::string> mistakes_;
};

class CrossMistake : public CrossChecks, public testing::WithParamInterface<Row> {};

TEST_P(CrossMistake, IsNamedWithItsLineAndCure) {
  const Settings settings = read(GetParam().text);
  expect_only(mistakes_, GetParam());
  EXPECT_TRUE(settings.warnings.empty());
}

INSTANTIATE_TEST_SUITE_P(
    Rows, CrossMistake,
    testing::Values(
        Row{"stale_before_it_is_asked_again",
            "[poll]\ninterval = \"10s\"\nleave_after = \"1min\"\n" + bus("127.0.0.1:502"), 5,
            "stale_after (5 s) is shorter than interval (10 s)", "make stale_after"},
        Row{"stale_before_it_is_asked_again_by_its_own_line",
            "[poll]\nstale_after = \"999ms\"\n" + bus("127.0.0.1:502"), 5,
            "stale_after (0.999 s) is shorter than interval (1 s)", "make stale_after"},
        Row{"no_port", bus("127.0.0.1:0"), 5, "port 0", "give the port"},
        Row{"itself", bus("127.0.0.1:1602") + "[server]\nlisten = \"127.0.0.1:1602\"\n", 5,
            "127.0.0.1:1602 is where this gateway itself serves the mesh", "give the address of"},
        Row{"shared_where_the_mesh_is_served",
            bus("127.0.0.1:502", "units = \"1\"\nshare = \"127.0.0.1:1502\"\n"), 7,
            "127.0.0.1:1502 is where [server] listens", "give share another port"},
        Row{"shared_where_the_page_is",
            bus("127.0.0.1:502", "units = \"1\"\nshare = \"[::]:8080\"\n") +
                "[http]\nlisten = \"10.0.0.1:8080\"\n",
            7, "[::]:8080 is where [http] listens", "give share another port"},
        Row{"two_shared_at_one_place",
            bus("10.0.0.1:502", "units = \"1\"\nname = \"a\"\nshare = \"0.0.0.0:1510\"\n") +
                bus("10.0.0.2:502", "units = \"1\"\nshare = \"127.0.0.1:1510\"\n"),
            12, "127.0.0.1:1510 is where bus 'a' is shared", "give share another port"},
        Row{"its_own_share", bus("127.0.0.1:1510", "units = \"1\"\nshare = \"127.0.0.1:1510\"\n"),
            5, "127.0.0.1:1510 is where this gateway itself shares bus", "give the address of"},
        Row{"the_share_of_another",
            bus("localhost:1510") +
                bus("10.0.0.2:502", "units = \"1\"\nname = \"b\"\nshare = \"[::]:1510\"\n"),
            5, "localhost:1510 is where this gateway itself shares bus 'b'", "give the address of"},
        Row{"share_without_a_place", bus("127.0.0.1:502", "units = \"1\"\nshare_writes = true\n"),
            7, "'share_writes' says how others may use the bus", "add share = "},
        Row{"itself_by_default", bus("127.0.0.1:1502"), 5, "this gateway itself serves the mesh",
            "give the address of"},
        Row{"itself_at_every_address",
            bus("127.0.0.2:1602") + "[server]\nlisten = \"0.0.0.0:1602\"\n", 5,
            "this gateway itself serves the mesh", "give the address of"},
        Row{"itself_by_name", bus("localhost:1502"), 5, "this gateway itself serves the mesh",
            "give the address of"},
        Row{"itself_by_ipv6", bus("[::1]:1602") + "[server]\nlisten = \"[::]:1602\"\n", 5,
            "[::1]:1602 is where this gateway itself serves the mesh", "give the address of"},
        Row{"itself_by_ipv4_at_every_address",
            bus("127.0.0.1:1602") + "[server]\nlisten = \"[::]:1602\"\n", 5,
            "this gateway itself serves the mesh", "give the address of"},
        Row{"itself_at_no_address", bus("0.0.0.0:1502"), 5, "this gateway itself serves the mesh",
            "give the address of"},
        Row{"its_page", bus("127.0.0.1:8080") + "[http]\n", 5, "this gateway itself shows its page",
            "give the address of"},
        Row{"alert_is_the_led",
            "[gpio]\nstatus_led = \"A\"\nalert = \"!A\"\n" + serial("") + "assign = \"2\"\n", 6,
            "the line A is status_led already", "give each a line"},
        Row{"watchdog_is_the_led_by_its_path",
            "[gpio]\nwatchdog = \"/dev/gpiochip0:3\"\nstatus_led = \"gpiochip0:3\"\n" + serial(""),
            6, "is watchdog already", "give each a line"},
        Row{"direction_is_the_led",
            "[gpio]\nstatus_led = \"DE\"\n" + serial("rs485_line = \"DE\"\n"), 9,
            "the line DE is status_led already", "give each a line"},
        Row{"neighbours_of_other_gateways_are_written",
            bus("127.0.0.1:502") +
                "[mqtt]\nbroker = \"10.1.1.1\"\nsite = \"yard\"\nname = \"north\"\nshare = "
                "\"site\"\n[write_back]\nenabled = true\n",
            13, "would write to devices here what other gateways tell by MQTT",
            "take enabled = true out, or write share = \"publish\""},
        Row{"two_buses_switch_one_line",
            serial("rs485_line = \"DE\"\n") +
                "[[bus]]\nrtu = \"/dev/ttyS1\"\nunits = \"1\"\nrs485_line = \"DE\"\n",
            11, "the line DE is rs485_line of bus '/dev/ttyS0' already", "give each a line"}),
    [](const auto& row) { return std::string(row.param.name); });

class CrossWarning : public CrossChecks, public testing::WithParamInterface<Row> {};

TEST_P(CrossWarning, IsNamedWithItsLineAndCure) {
  const Settings settings = read(GetParam().text);
  EXPECT_TRUE(mistakes_.empty()) << testing::PrintToString(mistakes_);
  expect_only(settings.warnings, GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    Rows, CrossWarning,
    testing::Values(
        Row{"a_network_with_bits_of_a_host",
            bus("127.0.0.1:502") + "[http]\nallow = [\"127.0.0.1\", \"10.1.2.3/8\"]\n", 8,
            "'allow' of [http] has \"10.1.2.3/8\", which is taken as the network 10.0.0.0/8",
            "write that, or \"10.1.2.3\" for this address alone"},
        Row{"a_network_of_ipv6_with_bits_of_a_host",
            bus("127.0.0.1:502") + "[server]\nallow = [\"2001:db8::7/33\"]\n", 8,
            "which is taken as the network 2001:db8::/33",
            "write that, or \"2001:db8::7\" for this"},
        Row{"leaves_before_it_is_stale", "[poll]\nstale_after = \"31s\"\n" + bus("127.0.0.1:502"),
            5, "stale_after (31 s) is longer than leave_after (30 s)", "make leave_after"},
        Row{"leaves_before_it_is_stale_by_the_other_line",
            "[poll]\nleave_after = \"4s\"\n" + bus("127.0.0.1:502"), 5,
            "stale_after (5 s) is longer than leave_after (4 s)", "make leave_after"},
        Row{"more_units_than_vertices",
            bus("127.0.0.1:502", "units = \"1-6\"\n") +
                bus("127.0.0.1:503", "units = \"1-3\"\nassign = \"10-11\"\n"),
            3, "the buses have 11 units", "set vertices_max to twice as many"},
        Row{"listens_for_others_and_lets_in_none",
            bus("127.0.0.1:502") + "[http]\nlisten = \"0.0.0.0:8080\"\n", 8,
            "'listen' of [http] is for other machines, but 'allow' lets in this one alone",
            "add your network there"},
        Row{"shares_a_bus_with_others_and_lets_in_none",
            bus("127.0.0.1:502", "name = \"yard\"\nshare = \"[::]:1510\"\nunits = \"1-8\"\n"), 7,
            "'share' of bus 'yard' is for other machines, but 'share_allow' lets in this one alone",
            "add your network there, such as share_allow = "},
        Row{"a_speed_that_is_hardly_meant", serial("baud = 19600\n"), 7,
            "baud = 19600 is no usual speed, and 19200 is near", "correct it"},
        Row{"a_line_too_slow_for_its_units",
            "features_max = 1\n[poll]\nstale_after = \"2s\"\n" +
                serial("baud = 1200\nname = \"yard\"\n") +
                "[[bus]]\nrtu = \"/dev/ttyS1\"\nunits = \"1-6\"\nbaud = 1200\n",
            14,
            "to ask all 6 units of bus '/dev/ttyS1' takes 2.42 s at 1200 baud at the least, and "
            "stale_after is 2 s",
            "raise baud or stale_after"}),
    [](const auto& row) { return std::string(row.param.name); });

TEST_F(CrossChecks, WhatIsSoundIsNotWarnedOf) {
  const Settings settings =
      read("[poll]\ninterval = \"5s\"\n[gpio]\nstatus_led = \"A\"\nwatchdog = \"B\"\n" +
           serial("rs485_line = \"DE\"\n") + bus("127.0.0.1:1503") +
           bus("127.0.0.1:1502", "units = \"2-8\"\nshare = \"127.0.0.1:1510\"\n") +
           bus("127.0.0.1:1504",
               "units = \"9\"\nshare = \"0.0.0.0:1511\"\nshare_allow = [\"10.0.0.0/8\"]\n") +
           "[server]\nlisten = \"10.0.0.1:1502\"\n"
           "allow = [\"10.0.0.0/8\"]\n");
  EXPECT_TRUE(mistakes_.empty()) << testing::PrintToString(mistakes_);
  EXPECT_TRUE(settings.warnings.empty()) << testing::PrintToString(settings.warnings);
}

// 247 is asked where units are assigned, but no node stays there.
TEST_F(CrossChecks, AUnitThatIsLookedForNeedsNoVertex) {
  const Settings settings =
      read(bus("127.0.0.1:502", "units = \"1-5\"\nassign = \"10-14\"\nscan = \"20-200\"\n"));
  EXPECT_TRUE(settings.warnings.empty()) << testing::PrintToString(settings.warnings);
}

TEST_F(CrossChecks, TwoNamesOfOneSerialPortAreAMistake) {
  const std::string port = folder_.path("ttyUSB0");
  std::filesystem::create_symlink("/dev/null", port);
  const std::string link = folder_.path("by-id");
  const std::string second_link = folder_.path("by-path");
  std::filesystem::create_symlink("ttyUSB0", link);
  std::filesystem::create_symlink(link, second_link);
  const auto two = [](const std::string& a, const std::string& b) {
    return "[[bus]]\nrtu = \"" + a + "\"\nunits = \"1\"\n[[bus]]\nrtu = \"" + b +
           "\"\nunits = \"2\"\n";
  };
  for (const auto& [a, b] : {std::pair{port, link},
                             {second_link, port},
                             {link, second_link},
                             {port, folder_.path("./ttyUSB0")}}) {
    read(two(a, b));
    expect_only(mistakes_, {.name = "",
                            .text = "",
                            .line = 8,
                            .what = "is the serial port of bus '",
                            .cure = "put the units of both into one"});
    EXPECT_NE(mistakes_[0].find(a), std::string::npos) << mistakes_[0];
    EXPECT_NE(mistakes_[0].find(b), std::string::npos) << mistakes_[0];
  }
  // An adapter may be plugged in later.
  std::filesystem::remove(port);
  read(two(link, second_link));
  EXPECT_TRUE(mistakes_.empty()) << testing::PrintToString(mistakes_);
}

TEST_F(CrossChecks, NobodyIsAskedWithoutABus) {
  const Settings settings = read("");
  EXPECT_TRUE(mistakes_.empty()) << testing::PrintToString(mistakes_);
  expect_only(settings.warnings, {.name = "",
                                  .text = "",
                                  .line = 1,
                                  .what = "there is no [[bus]], so nobody is asked",
                                  .cure = "add one with tcp or rtu, and units"});
}

TEST_F(CrossChecks, AnOfficeWithoutShareIsToldOfIt) {
  const std::string mqtt = "[mqtt]\nbroker = \"10.1.1.1\"\nsite = \"mill\"\nname = \"office\"\n";
  for (const char* const share : {"", "share = \"publish\"\n"}) {
    const std::vector<std::string> warnings = read(mqtt + share).warnings;
    ASSERT_EQ(warnings.size(), 1u) << testing::PrintToString(warnings);
    EXPECT_NE(
        warnings[0].find("there is no [[bus]], and no share = \"site\", so the mesh stays empty; "
                         "set share = \"site\" in [mqtt]"),
        std::string::npos)
        << warnings[0];
  }
  EXPECT_TRUE(read(mqtt + "share = \"site\"\n").warnings.empty());
}

TEST_F(CrossChecks, AFileIsNoSerialPort) {
  const std::string path = folder_.write("ttyUSB0", "");
  read("[[bus]]\nrtu = \"" + path + "\"\nunits = \"1\"\n");
  expect_only(mistakes_, {.name = "",
                          .text = "",
                          .line = 5,
                          .what = "is a file, and no serial port",
                          .cure = "give the path of one (ls /dev/serial/by-path lists them)"});
  read("[[bus]]\nrtu = \"/dev\"\nunits = \"1\"\n");
  EXPECT_NE(mistakes_.back().find("/dev is a folder, and no serial port"), std::string::npos);
}

// A [[node]] in the plane stands at a whole unit, and where that is not what it says, it is said.
TEST(SurveyedPlace, ThatIsNoWholeUnitIsWarnedOf) {
  const auto warnings = [](const std::string& site, const std::string& place) {
    test::ScratchFolder folder;
    std::vector<std::string> mistakes;
    const std::string text =
        "[mesh]\nvertices_max = 10\n[[profile]]\nname = \"meter\"\n[[profile.reading]]\n"
        "name = \"level\"\nvalue = { register = 3 }\n[[bus]]\ntcp = \"127.0.0.1:502\"\n"
        "[[bus.device]]\nunits = \"7\"\nprofile = \"meter\"\n[site]\n";
    const Settings settings = read_configuration(
        folder.write("site.toml", text + site + "[[node]]\nunit = 7\n" + place), nullptr, mistakes);
    EXPECT_EQ(mistakes, std::vector<std::string>{});
    return settings.warnings;
  };
  const std::string place = "x = \"2.6\"\ny = \"-400\"\n";
  const auto found = warnings("", place);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(found[0].ends_with(
      "site.toml:14: x and y are no whole numbers of units; it stands at the nearest, (3, -400) to "
      "the mesh; set a smaller unit in [site], or round = true if that is meant"))
      << found[0];
  EXPECT_EQ(warnings("round = true\n", place), std::vector<std::string>{});
  EXPECT_EQ(warnings("unit = \"0.2\"\n", place), std::vector<std::string>{});
  EXPECT_EQ(warnings("unit = \"0.25\"\norigin = [\"2.35\", \"0\"]\n", place),
            std::vector<std::string>{});
  EXPECT_EQ(warnings("origin = [\"0.5\", \"0\"]\n", "x = \"2\"\ny = \"0\"\n").size(), 1u);
}

}  // namespace
}  // namespace etcm::firmware
