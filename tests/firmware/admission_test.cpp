// Who a node is: by its serial, whichever unit it answers at, and what cannot be is an alarm.
#include <gtest/gtest.h>

#include "fakes.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

class NodesBySerial : public testing::Test {
 protected:
  void put(std::uint8_t unit, std::uint32_t serial, Position position) {
    rig_.bus.set(
        unit, {.serial = Serial{serial}, .position = position, .status = node_status::fix_valid});
  }
  std::vector<QuarantineEntry> quarantine() const {
    const auto list = rig_.gateway->quarantine();
    return {list.begin(), list.end()};
  }
  // Node 7 is in the mesh, and answers at unit 1.
  void seat_seven() {
    put(1, 7, {0, 0});
    rig_.run(500ms);
  }
  // Another node answers in its place, and it is back.
  void let_nine_come_and_go() {
    seat_seven();
    put(1, 9, {50, 0});
    rig_.run(1s);
    EXPECT_EQ(rig_.log.count("node 9 is there now, node 7 is not"), 1u) << logged();
    put(1, 7, {0, 0});
    rig_.run(4s);
    EXPECT_EQ(rig_.log.count("node 7 is there now, node 9 is not"), 1u) << logged();
  }
  void ask_one_unit(port::Duration patience) {
    rig_.settings.buses[0].units = {{.first = 1, .last = 1}};
    rig_.settings.poll.leave_after = patience;
    rig_.settings.poll.stale_after = patience;
  }
  // Node after node at unit 1, each for long enough to be believed.
  void let_answer_in_turn(std::uint32_t count) {
    for (std::uint32_t serial = 1; serial <= count; ++serial) {
      put(1, serial, {static_cast<std::int32_t>(serial), 0});
      rig_.run(600ms);
    }
  }
  // Until unit 1 has answered so often.
  void run_reads(std::uint32_t count) { run_reads_of(1, count); }
  void run_reads_of(std::uint8_t unit, std::uint32_t count) {
    rig_.run(10ms);
    for (const std::uint32_t before = rig_.bus.reads[unit]; rig_.bus.reads[unit] - before < count;)
      rig_.run(10ms);
  }
  std::string logged() const { return testing::PrintToString(rig_.log.lines); }

  Rig rig_;
};

TEST_F(NodesBySerial, ANodeMayChangeItsUnitAndStaysTheSameVertex) {
  put(1, 7, {0, 0});
  put(3, 8, {100, 0});
  rig_.run(500ms);
  const std::uint32_t generation = rig_.gateway->generation();
  rig_.bus.silence(1);
  put(2, 7, {0, 0});
  rig_.run(5s);
  EXPECT_EQ(rig_.log.count("node 7 went from unit 1 of yard to unit 2 of yard"), 1u) << logged();
  EXPECT_EQ(rig_.log.count("joined"), 2u);
  EXPECT_EQ(rig_.log.count("left"), 0u);
  EXPECT_EQ(rig_.log.count("two nodes"), 0u) << logged();
  EXPECT_EQ(rig_.gateway->generation(), generation) << "the mesh is the same";
}

TEST_F(NodesBySerial, TwoNodesThatSwapTheirUnitsStayWhereTheyAre) {
  put(1, 7, {0, 0});
  put(2, 8, {100, 0});
  rig_.run(500ms);
  const std::uint32_t generation = rig_.gateway->generation();
  put(2, 7, {0, 0});
  put(1, 8, {100, 0});
  rig_.run(5s);
  EXPECT_EQ(rig_.log.count("two nodes"), 0u) << logged();
  EXPECT_EQ(rig_.log.count("left"), 0u) << logged();
  EXPECT_EQ(rig_.gateway->generation(), generation);
  put(1, 8, {110, 0});
  rig_.run(500ms);
  EXPECT_EQ(rig_.log.count("node 8 moved from (100, 0) to (110, 0)"), 1u) << logged();
}

TEST_F(NodesBySerial, ANodeThatIsExchangedIsBelievedAfterAFewAnswersAndTheOldOneLeaves) {
  seat_seven();
  put(1, 5000, {99, 99});
  rig_.run(100ms);
  EXPECT_EQ(rig_.log.count("5000"), 0u) << "one answer is not enough";
  rig_.run(900ms);
  EXPECT_EQ(rig_.log.count("unit 1 of yard: node 5000 is there now, node 7 is not"), 1u)
      << logged();
  EXPECT_EQ(rig_.log.count("node 5000 joined at (99, 99)"), 1u);
  EXPECT_EQ(rig_.mesh.node_count(), 2u);
  rig_.run(4s);
  EXPECT_EQ(rig_.log.count("node 7 left (silent)"), 1u);
  EXPECT_EQ(rig_.mesh.node_count(), 1u);
}

TEST_F(NodesBySerial, ASerialThatAnswersOnceIsNotBelieved) {
  seat_seven();
  for (int round = 0; round < 20; ++round) {
    put(1, round % 2 == 0 ? 9u : 7u, {round % 2 == 0 ? 50 : 0, 0});
    rig_.run(100ms);
  }
  EXPECT_EQ(rig_.mesh.node_count(), 1u);
  EXPECT_EQ(rig_.log.count("joined"), 1u) << logged();
}

// Its position is its own, and never that of the node that is known there.
TEST_F(NodesBySerial, NorIsOneThatAnswersTwiceInARow) {
  seat_seven();
  for (int round = 0; round < 10; ++round) {
    put(1, 9, {50, 0});
    run_reads(2);
    put(1, 7, {0, 0});
    run_reads(1);
  }
  EXPECT_EQ(rig_.mesh.node_count(), 1u);
  EXPECT_EQ(rig_.mesh.position(VertexId{1}), (Position{0, 0}));
  EXPECT_EQ(rig_.log.count("9 "), 0u) << logged();
  put(1, 9, {50, 0});
  run_reads(3);
  EXPECT_EQ(rig_.log.count("node 9 is there now, node 7 is not"), 1u) << logged();
}

TEST_F(NodesBySerial, NorIsTheLastOfThreeThatAnswerOnceEach) {
  seat_seven();
  for (const std::uint32_t serial : {9u, 10u, 11u}) {
    put(1, serial, {50, 0});
    run_reads(1);
  }
  put(1, 7, {0, 0});
  run_reads(1);
  EXPECT_EQ(rig_.log.count("is there now"), 0u) << logged();
  EXPECT_EQ(rig_.mesh.node_count(), 1u);
}

TEST_F(NodesBySerial, WhoWasHeardElsewhereOnceMayGoThereLater) {
  seat_seven();
  put(2, 8, {100, 0});
  rig_.run(500ms);
  put(2, 7, {0, 0});
  run_reads_of(2, 2);
  put(2, 8, {100, 0});
  rig_.run(5s);
  rig_.bus.silence(1);
  put(2, 7, {0, 0});
  rig_.run(5s);
  EXPECT_EQ(rig_.log.count("two nodes"), 0u) << logged();
  EXPECT_EQ(rig_.log.count("node 7 went from unit 1 of yard to unit 2 of yard"), 1u) << logged();
}

TEST_F(NodesBySerial, TwoNodesWithOneSerialAreAnAlarmNotAFlipFlop) {
  seat_seven();
  put(2, 7, {99, 99});
  rig_.run(30s);
  EXPECT_EQ(rig_.mesh.position(VertexId{1}), (Position{0, 0}));
  EXPECT_EQ(rig_.log.count("two nodes with serial 7: unit 1 of yard and unit 2 of yard"), 1u);
  EXPECT_EQ(rig_.log.lines.size(), 2u) << logged();
  ASSERT_EQ(quarantine().size(), 1u);
  EXPECT_EQ(quarantine()[0].serial, Serial{7u});
  EXPECT_EQ(quarantine()[0].unit_index, UnitIndex{1});
  EXPECT_EQ(quarantine()[0].conflict, IdentityConflict::same_serial);
  EXPECT_EQ(rig_.server.header("quarantined_count"), 1u);
  EXPECT_EQ(rig_.server.header("state"), snapshot_state::partial);
  // The second goes: all is well again.
  rig_.bus.silence(2);
  rig_.run(5s);
  EXPECT_EQ(rig_.server.header("quarantined_count"), 0u);
  EXPECT_EQ(rig_.server.header("state"), 0u);
}

TEST_F(NodesBySerial, TheSecondWithOneSerialWaitsUntilTheFirstHasLeft) {
  put(1, 7, {0, 0});
  put(2, 7, {99, 99});
  rig_.run(2s);
  rig_.bus.silence(1);
  rig_.run(2500ms);
  EXPECT_EQ(rig_.mesh.position(VertexId{1}), (Position{0, 0}));
  rig_.run(2s);
  EXPECT_EQ(rig_.mesh.node_count(), 1u);
  EXPECT_EQ(rig_.mesh.position(VertexId{1}), (Position{99, 99}));
  EXPECT_EQ(rig_.log.count("node 7 left (silent)"), 1u) << logged();
}

TEST_F(NodesBySerial, TwoNodesAtOneUnitAreAnAlarmNotAFlipFlop) {
  seat_seven();
  // Now one is heard for a while, now the other.
  for (int round = 0; round < 20; ++round) {
    put(1, round % 2 == 0 ? 9u : 7u, {round % 2 == 0 ? 50 : 0, 0});
    rig_.run(1s);
  }
  EXPECT_EQ(rig_.log.count("two nodes answer as unit 1 of yard: serials 9 and 7"), 1u) << logged();
  EXPECT_EQ(rig_.log.count("is there now"), 1u) << logged();
  EXPECT_EQ(rig_.mesh.node_count(), 1u);
  ASSERT_EQ(quarantine().size(), 1u);
  EXPECT_EQ(quarantine()[0].conflict, IdentityConflict::same_unit);
}

TEST_F(NodesBySerial, TheAlarmOfTwoNodesAtOneUnitEndsWhereOneOfThemIsTakenAway) {
  let_nine_come_and_go();
  put(1, 9, {50, 0});
  rig_.run(1s);
  ASSERT_EQ(quarantine().size(), 1u) << logged();
  put(1, 7, {0, 0});
  rig_.run(5s);
  EXPECT_TRUE(quarantine().empty());
  EXPECT_EQ(rig_.server.header("quarantined_count"), 0u);
}

// Such as a device that was given the serial of another by mistake.
TEST_F(NodesBySerial, WhoGetsItsSerialBackIsNoSecondNode) {
  let_nine_come_and_go();
  EXPECT_EQ(rig_.log.count("two nodes answer"), 0u) << logged();
  EXPECT_TRUE(quarantine().empty());
  // Once is a mistake that was mended; again is two nodes.
  put(1, 9, {50, 0});
  rig_.run(1s);
  EXPECT_EQ(rig_.log.count("two nodes answer as unit 1 of yard"), 1u) << logged();
}

// What two nodes did there before does not count against those who come when both have gone.
TEST_F(NodesBySerial, NorIsItWhereTwoOthersAnsweredBeforeTheyWent) {
  put(2, 20, {300, 0});
  let_nine_come_and_go();
  rig_.bus.silence(1);
  rig_.run(10s);
  ASSERT_EQ(rig_.log.count("node 7 left (silent)"), 1u) << logged();
  put(1, 8, {20, 0});
  rig_.run(1s);
  put(1, 10, {30, 0});
  rig_.run(1s);
  ASSERT_EQ(rig_.log.count("node 10 is there now, node 8 is not"), 1u) << logged();
  put(1, 8, {20, 0});
  rig_.run(4s);
  EXPECT_EQ(rig_.log.count("node 8 is there now, node 10 is not"), 1u) << logged();
  EXPECT_EQ(rig_.log.count("two nodes answer"), 0u) << logged();
}

TEST_F(NodesBySerial, ASwappedSerialIsNotBelievedAndSaidOnce) {
  seat_seven();
  put(1, swap_words(Serial{7}).value, {50, 0});
  rig_.run(2s);
  EXPECT_EQ(rig_.mesh.position(VertexId{1}), (Position{0, 0}));
  EXPECT_EQ(rig_.log.count("which is 7 with its words swapped; set `word_order`"), 1u) << logged();
}

TEST_F(NodesBySerial, NodesOnSeveralBusesChangeTheirBus) {
  ScriptedBus quay;
  rig_.settings.buses.push_back(rig_.settings.buses[0]);
  rig_.settings.buses[1].name = "quay";
  rig_.start_with({&rig_.bus, &quay});
  put(1, 7, {0, 0});
  quay.set(1, {.serial = Serial{8}, .position = {100, 0}, .status = node_status::fix_valid});
  rig_.run(1s);
  EXPECT_EQ(rig_.mesh.node_count(), 2u);
  // The whole bus goes, so nobody can say that the node is not there any more; it is not heard.
  rig_.bus.link_up = false;
  quay.set(2, {.serial = Serial{7}, .position = {0, 0}, .status = node_status::fix_valid});
  rig_.run(2s);
  EXPECT_EQ(rig_.log.count("node 7 went from unit 1 of yard to unit 2 of quay"), 1u) << logged();
  EXPECT_EQ(rig_.log.count("left"), 0u);
  // Its old bus comes back, with a copy of it.
  rig_.bus.link_up = true;
  rig_.run(2s);
  EXPECT_EQ(rig_.log.count("two nodes with serial 7: unit 2 of quay and unit 1 of yard"), 1u)
      << logged();
}

TEST_F(NodesBySerial, MoreNodesThanThereIsRoomForAreRefusedAndSaid) {
  ask_one_unit(10min);
  let_answer_in_turn(30);
  EXPECT_EQ(rig_.log.count("no room to know node"), 13u) << logged();
  EXPECT_EQ(rig_.mesh.node_count(), 17u);
}

TEST_F(NodesBySerial, WhoHadNoRoomMustAnswerInARowAgainOnceThereIsSome) {
  ask_one_unit(20s);
  let_answer_in_turn(18);
  ASSERT_EQ(rig_.log.count("no room to know node 18"), 1u) << logged();
  put(1, 17, {17, 0});
  rig_.run(12s);
  ASSERT_EQ(rig_.log.count("node 1 left"), 1u) << logged();
  put(1, 18, {18, 0});
  run_reads(2);
  EXPECT_EQ(rig_.log.count("node 18 is there now"), 0u) << logged();
  run_reads(1);
  EXPECT_EQ(rig_.log.count("node 18 is there now, node 17 is not"), 1u) << logged();
}

TEST_F(NodesBySerial, WhoIsNotMissedGivesWayToNobodyThoughItHasToldNoPlace) {
  ask_one_unit(10min);
  for (std::uint32_t serial = 1; serial <= 20; ++serial) {
    rig_.bus.set(1, {.serial = Serial{serial}, .position = {}, .status = 0});
    rig_.run(600ms);
  }
  EXPECT_EQ(rig_.log.count("no room to know node"), 3u) << logged();
  EXPECT_EQ(rig_.log.count("is no longer missed"), 0u) << logged();
  EXPECT_NE(rig_.gateway->nodes().find(Serial{1}), nullptr);
}

}  // namespace
}  // namespace etcm::firmware
