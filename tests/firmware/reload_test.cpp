// Another configuration while the gateway runs: what changes at once, what needs a restart, and
// that a wrong one changes nothing.
#include "firmware/config/reload.h"

#include <gtest/gtest.h>

#include "fakes.h"
#include "firmware/config/configuration.h"
#include "support/scratch_folder.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

class Reload : public testing::Test {
 protected:
  static constexpr const char* good =
      "[mesh]\nvertices_max = 50\nfeatures_max = 9\n"
      "[poll]\ninterval = \"100ms\"\n"
      "[[bus]]\ntcp = \"127.0.0.1:502\"\nunits = \"1-3\"\n"
      "[[feature]]\nfrom = 1\nto = 2\n";

  Reload() : path_(folder_.write("site.toml", good)) {
    std::vector<std::string> mistakes;
    settings_ = read_configuration(path_, nullptr, mistakes);
    EXPECT_TRUE(mistakes.empty()) << mistakes.front();
  }
  bool reload_with(std::string text) {
    folder_.write("site.toml", text);
    log_.lines.clear();
    const auto next = reload(path_, settings_, nullptr, log_, refusal_, &waiting_);
    if (next == nullptr) return false;
    settings_ = *next;
    return true;
  }
  static std::string with(const std::string& from, const std::string& to) {
    std::string text = good;
    return text.replace(text.find(from), from.size(), to);
  }

  test::ScratchFolder folder_;
  std::string path_;
  Settings settings_;
  RecordingLog log_;
  std::string refusal_;
  std::vector<std::string> waiting_;
};

TEST_F(Reload, WhatNeedsARestartIsKnownUntilItIsTakenBack) {
  EXPECT_TRUE(reload_with(with("vertices_max = 50", "vertices_max = 60")));
  EXPECT_EQ(waiting_, std::vector<std::string>{"[mesh] vertices_max"});
  EXPECT_FALSE(reload_with("nonsense"));
  EXPECT_EQ(waiting_, std::vector<std::string>{"[mesh] vertices_max"});
  EXPECT_TRUE(reload_with(good));
  EXPECT_EQ(waiting_, std::vector<std::string>{});
}

TEST_F(Reload, ABusIsSharedAnotherWayOrNoMore) {
  const std::string shared =
      "units = \"1-3\"\nshare = \"127.0.0.1:1510\"\nshare_allow = [\"10.0.0.0/8\"]\n"
      "share_units = \"2\"\nshare_writes = true\nshare_time = 30\nshare_wait = \"2s\"\n";
  EXPECT_TRUE(reload_with(with("units = \"1-3\"\n", shared)));
  EXPECT_EQ(log_.count("needs a restart"), 0u) << log_.lines.front();
  const ShareSettings& share = settings_.buses[0].share;
  EXPECT_EQ(share.listen, port::parse_socket_address("127.0.0.1:1510"));
  EXPECT_EQ(share.allow.size(), 1u);
  EXPECT_EQ(share.units, (std::vector<UnitRange>{{.first = 2, .last = 2}}));
  EXPECT_TRUE(share.writes);
  EXPECT_EQ(share.percent, 30u);
  EXPECT_EQ(share.wait_max, 2s);
  EXPECT_TRUE(reload_with(good));
  EXPECT_FALSE(settings_.buses[0].share.listen);
  EXPECT_FALSE(settings_.buses[0].share.writes);
}

TEST_F(Reload, WhatCanChangeChanges) {
  EXPECT_TRUE(
      reload_with("[mesh]\nvertices_max = 50\nfeatures_max = 9\n"
                  "[poll]\ninterval = \"300ms\"\ntimeout = \"70ms\"\ndead_band = 5\n"
                  "stale_after = \"7s\"\nleave_after = \"9s\"\n"
                  "[[bus]]\ntcp = \"127.0.0.1:502\"\nunits = \"1-3\"\n"
                  "[[feature]]\nfrom = 1\nto = 3\n[[feature]]\nfrom = 2\nto = 3\n"));
  EXPECT_EQ(settings_.poll.interval, 300ms);
  EXPECT_EQ(settings_.poll.dead_band, 5u);
  EXPECT_EQ(settings_.poll.leave_after, 9s);
  EXPECT_EQ(settings_.buses[0].timeout, 70ms);
  EXPECT_EQ(settings_.features.size(), 2u);
  EXPECT_EQ(log_.count("needs a restart"), 0u) << log_.lines.front();
  EXPECT_EQ(log_.count("is read again"), 1u);
}

TEST_F(Reload, WhatIsWarnedOfAtTheStartIsWarnedOfAgain) {
  ASSERT_TRUE(
      reload_with(with("interval = \"100ms\"", "interval = \"100ms\"\nleave_after = \"4s\"")));
  EXPECT_EQ(log_.count("site.toml:6: stale_after (5 s) is longer than leave_after (4 s)"), 1u);
}

TEST_F(Reload, WhatCannotIsSaid) {
  for (const auto& [from, to, key] :
       {std::tuple{"vertices_max = 50", "vertices_max = 60", "[mesh] vertices_max"},
        {"features_max = 9", "features_max = 10", "[mesh] features_max"},
        {"127.0.0.1:502", "127.0.0.1:503", "[[bus]] tcp of '127.0.0.1:502'"},
        {"1-3", "1-2,4", "[[bus]] units of '127.0.0.1:502'"},
        {"units = \"1-3\"", "units = \"1-2\"\nscan = \"3\"", "[[bus]] units of '127.0.0.1:502'"},
        {"tcp = \"127.0.0.1:502\"", "rtu = \"/dev/ttyS0\"", "[[bus]] rtu of '127.0.0.1:502'"},
        {"[[bus]]", "[[bus]]\ntcp = \"127.0.0.1:503\"\nunits = \"1-3\"\n[[bus]]",
         "[[bus]] tcp of '127.0.0.1:502'"},
        {"[[feature]]",
         "[[bus]]\nrtu = \"/dev/ttyS9\"\nunits = \"1\"\nrs485_line = \"DE\"\n[[feature]]",
         "[[bus]] rs485_line of '/dev/ttyS9'"},
        {"[[feature]]", "[[bus.device]]\nunits = \"2\"\npause = \"9ms\"\n[[feature]]",
         "[[bus.device]] units"},
        {"units = \"1-3\"", "units = \"1-60\"",
         "[[bus]] units (they are 60, and there is room for 50"},
        {"[poll]", "[server]\nlisten = \"127.0.0.1:99\"\n[poll]", "[server] listen"},
        {"[poll]", "[files]\nfolder = \"x\"\n[poll]", "[files]"},
        {"[poll]", "[gpio]\nstatus_led = \"LED\"\n[poll]", "[gpio] status_led"}}) {
    const Settings before = settings_;
    EXPECT_TRUE(reload_with(with(from, to)));
    EXPECT_EQ(log_.count(std::string("needs a restart: ") + key), 1u) << key;
    EXPECT_GE(log_.count("needs a restart"), 1u) << key;
    EXPECT_EQ(settings_.buses.size(), 1u) << key;
    EXPECT_EQ(settings_.mesh.vertices_max, before.mesh.vertices_max);
    EXPECT_EQ(settings_.buses[0].units[0].last, before.buses[0].units[0].last);
  }
}

TEST_F(Reload, AWrongOneChangesNothingAndIsNamed) {
  for (const std::string& text :
       {with("interval = \"100ms\"", "interval = 100"), std::string("[mesh"), std::string(),
        with("to = 2", "to = 1"), with("[poll]", "[site]\nfile = \"nowhere.poly\"\n[poll]")}) {
    EXPECT_FALSE(reload_with(text));
    EXPECT_EQ(settings_.poll.interval, 100ms);
    ASSERT_EQ(settings_.features.size(), 1u);
    EXPECT_EQ(settings_.features[0].to, FeatureEnd(Serial{2}));
    EXPECT_GE(log_.lines.size(), 2u);
    EXPECT_TRUE(log_.lines.front().starts_with(folder_.path(""))) << log_.lines.front();
    EXPECT_EQ(log_.count("is not taken over, the old one stays"), 1u);
  }
  std::filesystem::remove(path_);
  EXPECT_EQ(reload(path_, settings_, nullptr, log_, refusal_), nullptr);
  EXPECT_EQ(settings_.features.size(), 1u);
}

TEST_F(Reload, WhatIsRefusedIsSaidInOneSentenceUntilItIsMended) {
  EXPECT_FALSE(reload_with(with("interval = \"100ms\"", "interval = 100")));
  EXPECT_EQ(refusal_.find("the configuration was changed and is refused: " + path_ + ":5: "), 0u)
      << refusal_;
  EXPECT_TRUE(refusal_.ends_with("; the old one holds until that is corrected and reloaded"));
  EXPECT_TRUE(reload_with(good));
  EXPECT_EQ(refusal_, "");
  std::string many = good;
  for (int i = 0; i < 33; ++i) many += "[[feature]]\nfrom = 1\nto = 1\n";
  EXPECT_FALSE(reload_with(many));
  EXPECT_NE(refusal_.find(" (and 32 more); "), std::string::npos) << refusal_;
  std::filesystem::remove(path_);
  EXPECT_EQ(reload(path_, settings_, nullptr, log_, refusal_), nullptr);
  EXPECT_NE(refusal_.find("No such file"), std::string::npos) << refusal_;
}

TEST_F(Reload, OfManyMistakesItTellsTheFirstAndHowManyMore) {
  std::string many = good;
  for (int i = 0; i < 33; ++i) many += "[[feature]]\nfrom = 1\nto = 1\n";
  EXPECT_FALSE(reload_with(many));
  EXPECT_EQ(log_.lines.size(), reload_mistakes_max + 2);
  EXPECT_EQ(log_.count("13 more mistakes; --check-config tells them all"), 1u);
  EXPECT_EQ(log_.count("is not taken over, the old one stays"), 1u);
}

TEST_F(Reload, ASiteThatDoesNotFitTheMeshThereIsIsRefused) {
  std::string more = with("features_max = 9", "features_max = 20");
  for (int i = 10; i < 20; ++i) {
    more += "[[feature]]\nfrom = " + std::to_string(i) + "\nto = 2\n";
  }
  EXPECT_FALSE(reload_with(more));
  EXPECT_EQ(log_.count("features_max in [mesh] is 9"), 1u);
  EXPECT_EQ(settings_.features.size(), 1u);
}

constexpr const char* added_meter =
    "[[profile]]\nname = \"meter\"\n"
    "[[profile.reading]]\nname = \"level\"\nvalue = { register = 0, type = \"u16\" }\n";

TEST_F(Reload, MayAddUnitsDevicesProfilesNodesAndBuses) {
  const std::string device =
      "[[bus.device]]\nunits = \"7-8\"\nprofile = \"meter\"\n"
      "[[bus.device]]\nunits = \"3\"\ntimeout = \"700ms\"\n";
  const std::string more =
      "[[bus]]\ntcp = \"plc.example:502\"\nname = \"other\"\n"
      "[[bus.device]]\nunits = \"9\"\nprofile = \"meter\"\n"
      "[[node]]\nbus = \"127.0.0.1:502\"\nunit = 7\nserial = 70\nx = \"5\"\ny = \"6\"\n"
      "[[node]]\nbus = \"other\"\nunit = 9\nx = \"1\"\ny = \"2\"\n";
  std::string text =
      with("units = \"1-3\"\n", "units = \"1-4\"\nscan = \"20-21\"\n" + device + more);
  ASSERT_TRUE(reload_with(text + added_meter)) << log_.lines.front();
  EXPECT_EQ(log_.count("needs a restart"), 0u) << log_.lines.front();
  EXPECT_EQ(log_.count("6 units more than before"), 1u) << log_.lines.back();
  ASSERT_EQ(settings_.buses.size(), 2u);
  EXPECT_EQ(settings_.nodes.size(), 2u);
  EXPECT_EQ(device_at(settings_.buses[0], ModbusAddress{8})->profile, "meter");
  EXPECT_EQ(timeout_of(settings_.buses[0], ModbusAddress{3}), 700ms);
  EXPECT_EQ(settings_.room.units, 50u) << "that of the start";
  // What was added stays what it is.
  text.replace(text.find("7-8"), 3, "7");
  EXPECT_TRUE(reload_with(text + added_meter));
  EXPECT_EQ(log_.count("needs a restart: [[bus]] units"), 1u);
  EXPECT_TRUE(reload_with(good));
  EXPECT_EQ(log_.count("needs a restart: [[bus]]"), 1u);
  EXPECT_EQ(log_.count("needs a restart: [[node]]"), 1u);
  EXPECT_EQ(log_.count("needs a restart: [[profile]]"), 1u);
  EXPECT_EQ(settings_.buses.size(), 2u);
}

TEST_F(Reload, NoMoreBusesAreAddedThanThereIsRoomFor) {
  std::string text = good;
  const auto add_bus = [&](int number) {
    text += "[[bus]]\ntcp = \"127.0.0.1:" + std::to_string(600 + number) + "\"\nunits = \"1\"\n";
  };
  for (int i = 0; i < 16; ++i) add_bus(i);
  EXPECT_TRUE(reload_with(text));
  EXPECT_EQ(settings_.buses.size(), 17u) << log_.lines.front();
  add_bus(16);
  EXPECT_TRUE(reload_with(text));
  EXPECT_EQ(log_.count("needs a restart: [[bus]] (there is room for 17)"), 1u)
      << log_.lines.front();
  EXPECT_EQ(settings_.buses.size(), 17u);
}

TEST_F(Reload, ADeviceThatIsAskedKeepsItsSerial) {
  const std::string bus =
      "[mesh]\nvertices_max = 50\nfeatures_max = 9\n[poll]\ninterval = \"100ms\"\n"
      "[[bus]]\ntcp = \"127.0.0.1:502\"\nunits = \"1-3\"\n"
      "[[bus.device]]\nunits = \"4\"\nprofile = \"meter\"\n";
  const std::string placed = bus + "[[node]]\nunit = 4\nx = \"5\"\ny = \"6\"\n";
  ASSERT_TRUE(reload_with(bus + added_meter));
  EXPECT_TRUE(reload_with(bus + "[[node]]\nunit = 4\nserial = 9\n" + added_meter));
  EXPECT_EQ(log_.count("needs a restart: [[node]]"), 1u);
  EXPECT_TRUE(reload_with(placed + added_meter));
  EXPECT_EQ(log_.count("needs a restart"), 0u) << "it was surveyed since";
  EXPECT_EQ(settings_.nodes.size(), 1u);
}

// The plane changes at once, whatever waits.
TEST_F(Reload, SurveyedNodesStandInTheNewPlaneWhereTheyWait) {
  const auto file = [](const std::string& plane, const std::string& units,
                       const std::string& places) {
    return "[mesh]\nvertices_max = 50\n[site]\ncrs = \"plane\"\n" + plane +
           "[[profile]]\nname = \"thermometer\"\n[[profile.reading]]\nname = \"air\"\n"
           "unit = \"Cel\"\nvalue = {register = 1, type = \"i16\"}\n"
           "[[bus]]\ntcp = \"127.0.0.1:502\"\n[[bus.device]]\nunits = \"" +
           units + "\"\nprofile = \"thermometer\"\n" + places;
  };
  const auto node = [](int unit, int x) {
    return "[[node]]\nunit = " + std::to_string(unit) + "\nx = \"" + std::to_string(x) +
           "\"\ny = \"0\"\n";
  };
  const auto x_of = [&](std::size_t i) {
    EXPECT_TRUE(settings_.nodes.at(i).position);
    return settings_.nodes.at(i).position.value_or(Position{}).x;
  };
  std::vector<std::string> mistakes;
  settings_ = read_configuration(
      folder_.write("site.toml", file("unit = \"0.1\"\n", "1-2", node(1, 10) + node(2, 30))),
      nullptr, mistakes);
  ASSERT_TRUE(mistakes.empty()) << mistakes.front();
  ASSERT_EQ(x_of(1), 300);

  ASSERT_TRUE(reload_with(file("unit = \"1\"\n", "1-2", node(1, 10) + node(2, 35))));
  EXPECT_EQ(waiting_, std::vector<std::string>{"[[node]]"});
  EXPECT_EQ(x_of(0), 10);
  EXPECT_EQ(x_of(1), 30) << "where it stood, in the new plane";

  const std::string moved = "unit = \"1\"\norigin = [\"5\", \"0\"]\n";
  ASSERT_TRUE(reload_with(file(moved, "1", node(1, 10))));
  EXPECT_EQ(waiting_.size(), 2u) << "units, and [[node]]";
  EXPECT_EQ(settings_.buses[0].devices[0].units[0].last, 2) << "the bus waits too";
  EXPECT_EQ(x_of(0), 5);
  EXPECT_EQ(x_of(1), 25) << "the one that is taken out";

  const std::string far = "unit = \"1\"\norigin = [\"16777240\", \"0\"]\n";
  EXPECT_FALSE(reload_with(file(far, "1", node(1, 33554440))));
  EXPECT_EQ(log_.count("has no place in the new plane"), 1u);
  EXPECT_EQ(x_of(1), 25) << "nothing was taken over";
}

TEST_F(Reload, UnitsAndBusesThatAreAddedAreAskedAndTheOthersGoOn) {
  Rig rig;
  rig.settings.room = {.units = 60, .buses = 4};
  rig.put_square();
  rig.run(2s);
  const std::uint32_t generation = rig.gateway->generation();
  const std::uint32_t asked = rig.bus.reads[1];
  rig.put(25, 50, 50);
  ScriptedBus other;
  other.set(7, {.serial = Serial{2007}, .position = {50, 20}, .status = node_status::fix_valid});
  rig.settings.buses[0].units.push_back({.first = 25, .last = 26});
  rig.settings.buses.push_back(rig.settings.buses[0]);
  rig.settings.buses[1].name = "gate";
  rig.settings.buses[1].units = {{.first = 7, .last = 8}};
  rig.update_settings({&other});
  rig.run(2s);
  EXPECT_EQ(rig.gateway->node_count(), 6u) << testing::PrintToString(rig.log.lines);
  EXPECT_EQ(rig.log.count("left"), 0u);
  EXPECT_EQ(rig.log.count("is silent"), 0u) << testing::PrintToString(rig.log.lines);
  EXPECT_EQ(rig.server.header("state"), 0u);
  EXPECT_GE(rig.bus.reads[1], asked + 18) << "each interval, as before";
  EXPECT_GT(rig.gateway->generation(), generation);
  EXPECT_EQ(rig.gateway->poller().unit_count(), 24u);
  other.silence(7);
  rig.run(10s);
  EXPECT_TRUE(rig.gateway->presence().is_silent(BusIndex{1}));
  EXPECT_EQ(rig.gateway->node_count(), 6u) << "a bus that is silent as a whole says nothing";
}

// Nobody was asked as often as the new settings have it, so nobody was silent.
TEST_F(Reload, ShorterPausesLetNobodyLeave) {
  Rig rig;
  const auto poll = [&](port::Duration interval, port::Duration stale, port::Duration leave) {
    rig.settings.poll.interval = interval;
    rig.settings.poll.absent_interval = 10 * interval;
    rig.settings.poll.stale_after = stale;
    rig.settings.poll.leave_after = leave;
  };
  poll(1min, 3min, 5min);
  rig.put_square();
  rig.run(130s);
  const std::uint32_t asked = rig.bus.reads[1];
  const std::uint32_t generation = rig.gateway->generation();
  rig.run(45s);  // they were heard long ago, as it will be
  poll(1s, 5s, 30s);
  rig.update_settings();
  rig.run(10s);
  EXPECT_GE(rig.bus.reads[1], asked + 9) << "the new interval holds at once";
  EXPECT_EQ(rig.log.count("left"), 0u) << testing::PrintToString(rig.log.lines);
  EXPECT_EQ(rig.server.header("stale_count"), 0u);
  EXPECT_EQ(rig.gateway->generation(), generation + 1) << "that of the reload";
  const std::uint32_t absent = rig.bus.reads[5];
  rig.run(40s);
  EXPECT_GE(rig.bus.reads[5], absent + 3) << "so do those for who does not answer";
  rig.bus.silence(1);
  rig.run(32s);
  EXPECT_EQ(rig.log.count("node 1001 left (silent)"), 1u);
}

TEST_F(Reload, OneThatIsSilentAlreadyLeavesAfterTheNewPause) {
  Rig rig;
  rig.put_square();
  rig.run(1s);
  rig.bus.silence(1);
  rig.run(2s);
  rig.update_settings();  // nothing has changed
  rig.run(1500ms);
  EXPECT_EQ(rig.log.count("node 1001 left (silent)"), 1u) << "3 s of silence";
}

TEST_F(Reload, AnAlarmOfTwoNodesEndsAfterTheNewPause) {
  Rig rig;
  rig.put_square();
  rig.bus.set(5, {.serial = Serial{1001}, .position = {50, 50}, .status = node_status::fix_valid});
  rig.run(5s);
  ASSERT_EQ(rig.gateway->quarantine().size(), 1u) << testing::PrintToString(rig.log.lines);
  rig.settings.poll.leave_after = 20s;
  rig.update_settings();
  rig.bus.silence(5);
  rig.run(10s);
  EXPECT_EQ(rig.gateway->quarantine().size(), 1u) << "it was 3 s";
  rig.run(12s);
  EXPECT_TRUE(rig.gateway->quarantine().empty());
}

TEST_F(Reload, TheRunningGatewayGoesByIt) {
  Rig rig;
  rig.put(1, 10, 10);
  rig.run(500ms);
  const std::uint32_t asked = rig.bus.reads[1];
  rig.settings.poll.interval = 50ms;
  rig.settings.poll.dead_band = 100;
  rig.update_settings();
  rig.run(1s);
  EXPECT_GE(rig.bus.reads[1] - asked, 17u);
  rig.put(1, 50, 10);
  rig.run(500ms);
  EXPECT_EQ(rig.log.count("moved"), 0u);
}

}  // namespace
}  // namespace etcm::firmware
