// How nodes that nobody has listed come in: a unit of their own for those at the default unit, and
// the search for units.
#include <gtest/gtest.h>

#include "fakes.h"
#include "memory_store.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

class Joining : public testing::Test {
 protected:
  void put(std::uint8_t unit, std::uint32_t serial, Position position = {5, 6}) {
    rig_.bus.set(
        unit, {.serial = Serial{serial}, .position = position, .status = node_status::fix_valid});
  }
  BusSettings& bus() { return rig_.settings.buses[0]; }
  std::string logged() const { return testing::PrintToString(rig_.log.lines); }

  Rig rig_;
};

TEST_F(Joining, ANodeAtTheDefaultUnitIsGivenTheFirstFreeOne) {
  bus().units = {{.first = 1, .last = 3}};
  bus().assign = {{.first = 10, .last = 12}};
  put(10, 900, {0, 0});
  put(247, 77);
  rig_.run(2s);
  EXPECT_EQ(rig_.log.count("node 77 has unit 11 of yard now"), 1u) << logged();
  EXPECT_EQ(rig_.log.count("joined"), 2u) << logged();
  EXPECT_EQ(rig_.log.count("left"), 0u);
  ASSERT_EQ(rig_.bus.written.size(), 1u);
  EXPECT_EQ(rig_.bus.written[0].address, 247);
  EXPECT_EQ(rig_.bus.written[0].first, 100);
  EXPECT_EQ(rig_.bus.written[0].values, (std::vector<std::uint16_t>{11, 0, 77, 0x4554}));
  // It is polled there, and its silence at the default unit is no news.
  put(11, 77, {50, 60});
  rig_.run(1s);
  EXPECT_EQ(rig_.log.count("node 77 moved from (5, 6) to (50, 60)"), 1u) << logged();
  EXPECT_EQ(rig_.log.count("unit 247"), 0u) << logged();
}

// It answers for units where nobody is.
TEST_F(Joining, AUnitThatAConverterFindsEmptyIsFree) {
  for (const std::uint8_t exception : {std::uint8_t{0x0a}, std::uint8_t{0x0b}}) {
    Rig rig;
    rig.settings.buses[0].units = {};
    rig.settings.buses[0].assign = {{.first = 10, .last = 12}};
    for (std::uint8_t unit = 10; unit <= 12; ++unit) {
      rig.bus.set_result(unit, port::BusResult::exception, exception);
    }
    rig.bus.set(247, {.serial = Serial{77}, .position = {5, 6}, .status = node_status::fix_valid});
    rig.run(2s);
    EXPECT_EQ(rig.bus.written.size(), 1u) << int{exception};
    EXPECT_EQ(rig.log.count("no unit is free"), 0u);
    EXPECT_EQ(rig.log.count("node 77 has unit 10 of yard now"), 1u)
        << testing::PrintToString(rig.log.lines);
  }
}

// What it does instead of answering.
TEST_F(Joining, AUnitForWhichAConverterEndsTheConnectionIsFree) {
  bus().units = {{.first = 1, .last = 1}};
  bus().assign = {{.first = 10, .last = 12}};
  put(1, 1, {0, 0});
  for (std::uint8_t unit = 10; unit <= 12; ++unit) {
    rig_.bus.set_result(unit, port::BusResult::link_lost);
  }
  put(247, 77);
  rig_.run(5s);
  EXPECT_EQ(rig_.log.count("node 77 has unit 10 of yard now"), 1u) << logged();
}

// A cable that is pulled out while it is looked at says nothing of it.
TEST_F(Joining, AUnitThatWasLookedAtWhenTheLinkWentIsNotFree) {
  bus().units = {{.first = 1, .last = 1}};
  bus().assign = {{.first = 10, .last = 10}};
  put(1, 1, {0, 0});
  put(247, 77);
  rig_.bus.set_result(10, port::BusResult::link_lost);
  rig_.run(150ms);
  put(10, 90, {50, 60});
  rig_.run(3s);
  EXPECT_TRUE(rig_.bus.written.empty());
  EXPECT_EQ(rig_.log.count("node 90 joined"), 1u) << logged();
}

// The units that are looked for are in no metric until somebody is there.
TEST_F(Joining, UnitsThatAConverterFindsEmptyAreAsUnseenAsSilentOnes) {
  bus().units = {{.first = 1, .last = 1}};
  bus().scan = {{.first = 2, .last = 20}};
  put(1, 1, {0, 0});
  for (std::uint8_t unit = 2; unit <= 20; ++unit) {
    rig_.bus.set_result(unit, port::BusResult::exception, 0x0b);
  }
  rig_.run(5s);
  const Poller& poller = rig_.gateway->poller();
  for (UnitIndex unit{1}; unit.value < 20; ++unit.value) {
    EXPECT_FALSE(poller.counters(unit).has_answered());
    EXPECT_EQ(poller.counters(unit).answered_at, port::Instant{});
    EXPECT_GT(poller.counters(unit).count(port::BusResult::timeout), 0u);
  }
  EXPECT_EQ(rig_.log.lines.size(), 1u) << logged();
}

TEST_F(Joining, OneAfterTheOtherUntilNoUnitIsFree) {
  bus().units = {};
  bus().assign = {{.first = 10, .last = 12}};
  for (std::uint32_t serial = 1; serial <= 5; ++serial) {
    if (serial <= 4) put(247, serial, {static_cast<std::int32_t>(serial), 0});
    rig_.run(3s);
  }
  EXPECT_EQ(rig_.log.count(" of yard now"), 3u) << logged();
  EXPECT_EQ(rig_.log.count("no unit is free for node 4, which stays at 247"), 1u) << logged();
  EXPECT_EQ(rig_.mesh.node_count(), 4u);
  EXPECT_EQ(rig_.server.header("state"), 0u);
}

TEST_F(Joining, AUnitWhereSomebodyAnswersAfterAllIsNotGiven) {
  bus().units = {};
  bus().assign = {{.first = 10, .last = 12}};
  rig_.run(1s);
  put(10, 900, {0, 0});  // it has been silent so far, and was not asked since
  put(247, 77);
  rig_.gateway->ask_at_once(default_unit, rig_.clock.now());
  rig_.run(3s);
  EXPECT_EQ(rig_.log.count("node 77 has unit 11 of yard now"), 1u) << logged();
  EXPECT_EQ(rig_.mesh.node_count(), 2u);
}

// Of two at the default unit one is heard, and the other one's answer falls into what is asked
// next.
TEST_F(Joining, AUnitIsAskedOnceMoreWhereAnotherHasTalkedIntoTheAnswer) {
  bus().assign = {{.first = 10, .last = 10}};
  rig_.bus.set_result(10, port::BusResult::bad_answer);
  put(247, 77);
  rig_.run(800ms);
  EXPECT_TRUE(rig_.bus.written.empty());
  rig_.bus.silence(10);
  rig_.run(2s);
  EXPECT_EQ(rig_.log.count("node 77 has unit 10 of yard now"), 1u) << logged();
  EXPECT_EQ(rig_.log.count("no unit is free"), 0u) << logged();
}

// A converter that was busy with others says nothing in time, though somebody is there.
TEST_F(Joining, AUnitIsFreeWhereNobodyAnswersTwice) {
  bus().assign = {{.first = 10, .last = 10}};
  put(247, 77);
  for (int turn = 0; turn < 2000 && rig_.bus.written.empty(); ++turn) rig_.run(1ms);
  ASSERT_EQ(rig_.bus.written.size(), 1u) << logged();
  EXPECT_GT(rig_.bus.reads[10], 2u) << "once as one of its units, and twice whether it is free";
}

// Nor is it silence twice while one dead unit holds up all that is asked behind it.
TEST_F(Joining, AUnitIsNotFreeWhereNobodyElseWasHeardSinceTheFirstLook) {
  bus().units = {{.first = 1, .last = 1}};
  bus().assign = {{.first = 10, .last = 10}};
  put(1, 1, {0, 0});
  put(247, 77);
  for (int turn = 0; turn < 1000 && rig_.log.count("node 77 joined") == 0; ++turn) rig_.run(1ms);
  for (const int unit : {1, 10, 247}) rig_.bus.silence(static_cast<std::uint8_t>(unit));
  rig_.run(500ms);
  EXPECT_TRUE(rig_.bus.writes.empty());
  put(10, 90, {50, 60});
  put(1, 1, {0, 0});
  put(247, 77);
  rig_.run(3s);
  EXPECT_TRUE(rig_.bus.writes.empty());
  EXPECT_EQ(rig_.log.count("node 90 joined"), 1u) << logged();
}

// Behind a converter that takes several questions: an answer that is under way says nothing of what
// was asked after its question.
TEST_F(Joining, AUnitIsNotFreeForAnAnswerToWhatWasAskedBeforeTheFirstLook) {
  for (port::Duration phase{}; phase < 100ms; phase += 5ms) {
    Rig rig;
    rig.settings.buses[0].units = {{.first = 1, .last = 1}};
    rig.settings.buses[0].assign = {{.first = 10, .last = 10}};
    rig.put(1, 0, 0);
    rig.bus.delays[1] = 40ms;
    rig.run(1s + phase, 1ms);
    rig.put(247, 5, 6);
    for (int turn = 0; turn < 1000 && rig.log.count("node 1247 joined") == 0; ++turn) rig.run(1ms);
    ASSERT_EQ(rig.log.count("node 1247 joined"), 1u);
    rig.bus.silence(247);
    rig.run(45ms, 1ms);
    rig.bus.delays[1] = 1h;
    rig.run(1s);
    EXPECT_TRUE(rig.bus.writes.empty()) << "at " << phase / 1ms;
  }
}

// Two who have one unit are never understood either.
TEST_F(Joining, AUnitWhoseAnswersAreAlwaysSpoiltIsNotGiven) {
  bus().assign = {{.first = 10, .last = 11}};
  rig_.bus.set_result(10, port::BusResult::bad_answer);
  put(247, 77);
  rig_.run(10s);
  EXPECT_EQ(rig_.log.count("node 77 has unit 11 of yard now"), 1u) << logged();
}

TEST_F(Joining, WhoAnswersWhereAUnitWasTakenForFreeIsHeardAtOnce) {
  rig_.settings.poll.absent_interval = 600s;
  bus().units = {{.first = 1, .last = 1}};
  bus().assign = {{.first = 10, .last = 10}};
  put(1, 3, {5, 9});  // the bus is never silent as a whole
  put(10, 1, {0, 0});
  rig_.run(1s);
  rig_.bus.silence(10);
  rig_.run(300s);
  ASSERT_EQ(rig_.log.count("left (silent)"), 1u) << logged();
  put(10, 1, {0, 0});
  put(247, 77);
  for (int turn = 0; turn < 1000 && rig_.log.count("node 77") == 0; ++turn) rig_.run(1s);
  rig_.run(1s);
  EXPECT_EQ(rig_.log.count("node 1 is back"), 1u) << logged();
  EXPECT_EQ(rig_.log.count("node 77 has unit"), 0u) << logged();
}

// Its battery is changed while newcomers wait: they must not be where it comes back.
TEST_F(Joining, AUnitWhoseNodeIsAwayIsGivenLast) {
  bus().units = {{.first = 1, .last = 1}};
  bus().assign = {{.first = 10, .last = 13}};
  put(1, 3, {5, 9});  // the bus is never silent as a whole
  put(10, 1, {0, 0});
  put(12, 2, {9, 0});
  rig_.run(1s);
  rig_.bus.silence(12);
  rig_.run(4s);
  rig_.bus.silence(10);
  rig_.run(4s);
  ASSERT_EQ(rig_.log.count("left (silent)"), 2u) << logged();
  // Those where nobody was; of the others the one that has been silent longer.
  for (const std::uint32_t serial : {77u, 78u, 79u}) {
    put(247, serial, {static_cast<std::int32_t>(serial), 5});
    rig_.run(2s);
  }
  EXPECT_EQ(rig_.log.count("node 77 has unit 11 of yard now"), 1u) << logged();
  EXPECT_EQ(rig_.log.count("node 78 has unit 13 of yard now"), 1u) << logged();
  EXPECT_EQ(rig_.log.count("node 79 has unit 12 of yard now"), 1u) << logged();
}

TEST_F(Joining, SoIsOneWhoseNodeIsOnlyKnownFromBeforeARestart) {
  MemoryStore store;
  Rig before;
  for (Rig* const rig : {&before, &rig_}) {
    rig->settings.state = StateSettings{.folder = "/state", .interval = 1s};
    rig->store = &store;
    rig->settings.buses[0].units = {};
    rig->settings.buses[0].assign = {{.first = 10, .last = 11}};
  }
  before.bus.set(10, {.serial = Serial{1}, .position = {0, 0}, .status = node_status::fix_valid});
  before.run(2s);
  rig_.settings.buses[0].units = {{.first = 1, .last = 1}};
  put(1, 3, {5, 9});
  rig_.start();
  rig_.gateway->restore(rig_.clock.now());
  rig_.run(5s);
  ASSERT_EQ(rig_.log.count("node 1 left (silent)"), 1u) << logged();
  put(247, 77);
  rig_.run(2s);
  EXPECT_EQ(rig_.log.count("node 77 has unit 11 of yard now"), 1u) << logged();
}

// What is no node answers there too.
TEST_F(Joining, SoIsOneWhereSomeOtherDeviceAnswered) {
  bus().units = {};
  bus().assign = {{.first = 10, .last = 11}};
  put(10, 1);
  rig_.bus.set_result(10, port::BusResult::exception, 2);
  rig_.run(1s);
  rig_.bus.silence(10);
  rig_.run(4s);
  put(247, 77);
  rig_.run(2s);
  EXPECT_EQ(rig_.log.count("node 77 has unit 11 of yard now"), 1u) << logged();
}

TEST_F(Joining, AWriteWithoutAnAnswerIsVerifiedAndTriedAgain) {
  bus().units = {};
  bus().assign = {{.first = 10, .last = 12}};
  put(247, 77);
  rig_.bus.refuse_writes(247, port::BusResult::timeout);
  rig_.run(3s);
  EXPECT_EQ(rig_.log.count("node 77 did not take unit 10 of yard: it does not answer there"), 1u)
      << logged();
  EXPECT_GE(rig_.bus.writes[247], 2u);
  EXPECT_LE(rig_.bus.writes[247], 6u);
  EXPECT_EQ(rig_.mesh.node_count(), 1u) << "it is in the mesh meanwhile";
  rig_.bus.refuse_writes(247, port::BusResult::ok);
  rig_.run(2s);
  EXPECT_EQ(rig_.log.count("node 77 has unit 10 of yard now"), 1u) << logged();
}

TEST_F(Joining, ANodeThatRefusesStaysAtTheDefaultUnit) {
  bus().units = {};
  bus().assign = {{.first = 10, .last = 12}};
  put(247, 77);
  rig_.bus.refuse_writes(247, port::BusResult::exception, 2);
  rig_.run(2s);
  EXPECT_GE(rig_.log.count("did not take unit 10 of yard: it answers with an exception"), 1u);
  EXPECT_EQ(rig_.bus.reads[10] > 0, true);
  EXPECT_EQ(rig_.mesh.node_count(), 1u);
}

TEST_F(Joining, OnlyTheNodeWithTheSerialTakesTheUnit) {
  // Between the answer and the write another node is at the default unit.
  bus().units = {};
  bus().assign = {{.first = 10, .last = 12}};
  put(247, 77);
  rig_.run(60ms);
  put(247, 78, {50, 60});
  rig_.run(5s);
  EXPECT_EQ(rig_.log.count("node 77 has unit"), 0u) << logged();
  EXPECT_EQ(rig_.log.count("node 78 has unit 10 of yard now"), 1u) << logged();
}

TEST_F(Joining, NobodyIsGivenAUnitWhereNobodyAskedForIt) {
  bus().units = {{.first = 1, .last = 3}, {.first = 247, .last = 247}};
  put(247, 77);
  rig_.run(2s);
  EXPECT_EQ(rig_.mesh.node_count(), 1u);
  EXPECT_TRUE(rig_.bus.writes.empty());
}

TEST_F(Joining, UnitsThatNobodyListedAreFoundOneInAnInterval) {
  bus().units = {{.first = 1, .last = 1}};
  bus().scan = {{.first = 1, .last = 50}};
  put(1, 1, {0, 0});
  put(33, 77);
  rig_.run(2s);
  std::uint32_t asked = 0;
  for (std::uint8_t unit = 2; unit <= 50; ++unit) asked += rig_.bus.reads[unit];
  EXPECT_LE(asked, 21u) << "one in each interval of 100 ms";
  EXPECT_GE(asked, 15u);
  EXPECT_EQ(rig_.bus.reads[1] >= 18, true);
  rig_.run(4s);
  EXPECT_EQ(rig_.log.count("node 77 joined at (5, 6)"), 1u) << logged();
  const std::uint32_t before = rig_.bus.reads[33];
  rig_.run(1s);
  EXPECT_GE(rig_.bus.reads[33], before + 9) << "it is polled like any other";
  EXPECT_EQ(rig_.log.lines.size(), 2u) << "silence of others is no news: " << logged();
}

TEST_F(Joining, AFoundUnitThatFallsSilentIsOnlyLookedForAgain) {
  bus().units = {{.first = 1, .last = 1}};
  bus().scan = {{.first = 2, .last = 5}};
  put(1, 1, {0, 0});
  put(4, 77);
  rig_.run(2s);
  rig_.bus.silence(4);
  rig_.run(20s);
  EXPECT_EQ(rig_.mesh.node_count(), 1u);
  const std::uint32_t before = rig_.bus.reads[4];
  rig_.run(4s);
  EXPECT_NEAR(rig_.bus.reads[4] - before, 10, 2) << "every fourth interval of 100 ms";
  put(4, 77, {7, 8});
  rig_.run(1s);
  EXPECT_EQ(rig_.log.count("node 77 joined at (7, 8)"), 1u) << logged();
}

TEST_F(Joining, FoundUnitsAreBackAtOnceWhenTheirCableIs) {
  bus().units = {};
  bus().scan = {{.first = 1, .last = 200}};
  for (std::uint8_t unit = 1; unit <= 5; ++unit) put(unit, unit, {unit * unit, unit});
  rig_.run(25s);
  ASSERT_EQ(rig_.mesh.node_count(), 5u) << logged();
  for (std::uint8_t unit = 1; unit <= 5; ++unit) rig_.bus.silence(unit);
  rig_.run(1min);
  EXPECT_EQ(rig_.server.header("stale_count"), 5u);
  for (std::uint8_t unit = 1; unit <= 5; ++unit) put(unit, unit, {unit * unit, unit});
  rig_.run(300ms);
  EXPECT_EQ(rig_.server.header("stale_count"), 0u);
}

TEST_F(Joining, ForeignDevicesAreNamedOnceAndLeftAlone) {
  bus().units = {};
  bus().scan = {{.first = 1, .last = 3}};
  rig_.bus.set_registers(2, NodeRegisters{});
  rig_.run(10s);
  EXPECT_EQ(rig_.log.count("unit 2 of yard: register 0 is not 0x4554"), 1u) << logged();
  EXPECT_LE(rig_.bus.reads[2], 40u);
}

TEST_F(Joining, OnABusyLineTheSearchKeepsToItsBudget) {
  rig_.bus.outstanding_max = 1;
  bus().outstanding_max = 1;
  bus().units = {{.first = 1, .last = 20}};
  bus().scan = {{.first = 21, .last = 247}};
  rig_.settings.poll.interval = 100ms;
  for (std::uint8_t unit = 1; unit <= 20; ++unit) put(unit, unit, {unit * unit, 7 * unit % 11});
  rig_.run(60s);
  std::uint32_t looked = 0;
  for (std::uint32_t unit = 21; unit <= 247; ++unit) {
    looked += rig_.bus.reads[static_cast<std::uint8_t>(unit)];
  }
  // Each costs 50 ms of waiting, 10 ms of each 100 ms may go into it.
  EXPECT_GE(looked, 80u);
  EXPECT_LE(looked, 125u);
  for (std::uint8_t unit = 1; unit <= 20; ++unit) EXPECT_GE(rig_.bus.reads[unit], 200u);
}

}  // namespace
}  // namespace etcm::firmware
