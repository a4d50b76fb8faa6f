// Gateway::step() with the real mesh, on a simulated clock and a scripted bus.
#include "firmware/gateway/gateway.h"

#include <gtest/gtest.h>

#include "etcm/audit.h"
#include "fakes.h"
#include "firmware/protocol/register_pairs.h"
#include "firmware/publish/mesh_registers.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

TEST(Gateway, NodesJoinAtOnceAndArePublished) {
  Rig rig;
  rig.put(1, 0, 0);
  rig.put(2, 100, 0);
  rig.put(3, 0, 100);
  rig.run(1s);
  EXPECT_EQ(rig.mesh.node_count(), 3u);
  EXPECT_EQ(rig.server.header("node_count"), 3u);
  EXPECT_EQ(rig.server.header("edge_count"), 3u);
  EXPECT_EQ(rig.server.header("triangle_count"), 1u);
  EXPECT_EQ(rig.server.header("state"), 0u);
  EXPECT_EQ(rig.log.count("node 1003 joined at (0, 100)"), 1u);
}

TEST(Gateway, ANodeThatJoinsAloneIsAGenerationOfItsOwn) {
  Rig rig;
  rig.put(1, 0, 0);
  rig.run(1s);
  const std::uint32_t before = rig.gateway->generation();
  rig.put(2, 100, 0);
  rig.run(1s);
  EXPECT_EQ(rig.gateway->generation(), before + 1);
  EXPECT_EQ(rig.log.count("node 1002 joined at (100, 0): 2 nodes"), 1u);
  EXPECT_TRUE(rig.log.details.back().starts_with("node 1002 joined: generation " +
                                                 std::to_string(before + 1) +
                                                 ", 1 neighbour, 0 Steiner vertices added, "))
      << rig.log.details.back();
}

TEST(Gateway, NothingIsPublishedWhileNothingChanges) {
  Rig rig;
  rig.put(1, 0, 0);
  rig.run(1s);
  EXPECT_EQ(rig.server.images.size(), 1u);
  EXPECT_EQ(rig.files.attempts, 1u);
  rig.run(5s);
  EXPECT_EQ(rig.server.images.size(), 1u);
  EXPECT_EQ(rig.files.attempts, 1u);
}

TEST(Gateway, EveryBlockCarriesTheGeneration) {
  Rig rig;
  for (std::uint8_t unit = 1; unit <= 20; ++unit) rig.put(unit, unit * unit, 7 * unit % 11);
  rig.run(2s);
  const auto& registers = rig.server.images.back()->registers;
  for (std::size_t block = 0; block < registers.size(); block += block_size) {
    EXPECT_EQ(load_u32(registers, block), rig.gateway->generation()) << block;
  }
}

TEST(Gateway, ANodeThatMovedIsFollowedBeyondTheDeadBand) {
  Rig rig;
  rig.settings.poll.dead_band = 5;
  rig.put(1, 0, 0);
  rig.run(500ms);
  rig.put(1, 3, 4);  // exactly the dead band
  rig.run(500ms);
  EXPECT_EQ(rig.mesh.position(VertexId{1}), (Position{0, 0}));
  rig.put(1, 3, 5);
  rig.run(500ms);
  EXPECT_EQ(rig.mesh.position(VertexId{1}), (Position{3, 5}));
  EXPECT_EQ(rig.log.count("node 1001 moved from (0, 0) to (3, 5)"), 1u);
}

TEST(Gateway, GpsJitterChangesNothingAndASlowDriftIsFollowed) {
  Rig rig;
  rig.settings.poll.dead_band = 10;
  rig.put(1, 0, 0);
  rig.put(2, 1000, 0);
  rig.put(3, 0, 1000);
  rig.run(500ms);
  const std::uint32_t generation = rig.gateway->generation();
  std::uint32_t chance = 1;
  for (int poll = 0; poll < 500; ++poll) {
    chance = chance * 1664525u + 1013904223u;
    rig.put(1, static_cast<std::int32_t>(chance >> 29) - 4,
            static_cast<std::int32_t>(chance >> 26 & 7) - 4);
    rig.run(100ms);
  }
  EXPECT_EQ(rig.gateway->generation(), generation);
  // Each step is well within the band; what counts is the way from where the mesh has it.
  for (int poll = 1; poll <= 100; ++poll) {
    rig.put(1, -poll, 0);
    rig.run(100ms);
  }
  EXPECT_EQ(rig.log.count("node 1001 moved"), 9u);
  EXPECT_EQ(rig.mesh.position(VertexId{1}), (Position{-99, 0}));
}

TEST(Gateway, ASilentNodeIsStaleThenLeavesAndComesBack) {
  Rig rig;
  rig.put(1, 0, 0);
  rig.put(2, 100, 0);
  rig.run(1s);
  rig.bus.silence(1);
  rig.run(1500ms);
  EXPECT_EQ(rig.mesh.node_count(), 2u);
  EXPECT_EQ(rig.server.header("stale_count"), 1u);
  EXPECT_EQ(rig.server.header("state"), snapshot_state::stale);
  rig.run(3s);
  EXPECT_EQ(rig.mesh.node_count(), 1u);
  EXPECT_EQ(rig.log.count("node 1001 left (silent)"), 1u);
  EXPECT_EQ(rig.server.header("state"), snapshot_state::missing);
  rig.put(1, 0, 0);
  rig.run(1s);
  EXPECT_EQ(rig.mesh.node_count(), 2u);
  EXPECT_EQ(rig.server.header("state"), 0u);
}

TEST(Gateway, ANodeMayAskToLeave) {
  Rig rig;
  rig.put(1, 0, 0);
  rig.run(500ms);
  rig.put(1, 0, 0, node_status::fix_valid | node_status::leaving);
  rig.run(500ms);
  EXPECT_EQ(rig.mesh.node_count(), 0u);
  EXPECT_EQ(rig.log.count("left (on its own request)"), 1u);
  rig.put(1, 0, 0);
  rig.run(500ms);
  EXPECT_EQ(rig.mesh.node_count(), 1u);
}

TEST(Gateway, WithoutAFixANodeStaysWhereItWas) {
  Rig rig;
  rig.put(1, 0, 0, 0);
  rig.run(500ms);
  EXPECT_EQ(rig.mesh.node_count(), 0u);
  rig.put(1, 5, 5);
  rig.run(500ms);
  rig.put(1, 99, 99, 0);
  rig.run(5s);
  EXPECT_EQ(rig.mesh.position(VertexId{1}), (Position{5, 5}));
}

TEST(Gateway, AFeatureIsActiveWhileBothItsEndsAreThere) {
  Rig rig({feature(1001, 1002)});
  rig.put(1, 0, 0);
  rig.put(3, 50, 40);
  rig.run(500ms);
  EXPECT_EQ(rig.mesh.feature_count(), 0u);
  EXPECT_EQ(rig.server.header("state"), snapshot_state::partial);
  rig.put(2, 100, 0);
  rig.run(500ms);
  EXPECT_EQ(rig.mesh.feature_count(), 1u);
  EXPECT_EQ(rig.server.header("features_active"), 1u);
  rig.bus.silence(2);
  rig.run(5s);
  EXPECT_EQ(rig.mesh.feature_count(), 0u);
  EXPECT_EQ(rig.mesh.node_count(), 2u);
  rig.put(2, 100, 10);
  rig.run(1s);
  EXPECT_EQ(rig.mesh.feature_count(), 1u);
  EXPECT_TRUE(audit(rig.mesh));
}

TEST(Gateway, ACrossingFeatureWaitsInQuarantineUntilTheOtherIsGone) {
  Rig rig({feature(1001, 1002), feature(1003, 1004)});
  rig.put(1, 0, 0);
  rig.put(2, 100, 100);
  rig.run(500ms);
  rig.put(3, 0, 100);
  rig.put(4, 100, 0);
  rig.run(500ms);
  EXPECT_EQ(rig.mesh.feature_count(), 1u);
  EXPECT_EQ(rig.server.header("quarantined_count"), 1u);
  EXPECT_EQ(rig.server.header("state"), snapshot_state::partial);
  EXPECT_EQ(rig.log.count("feature 2 (1003-1004, site.toml:1) refused"), 1u);
  EXPECT_EQ(rig.log.count("feature 1 (1001-1002"), 1u)
      << "the reason names the other feature: " << testing::PrintToString(rig.log.lines);
  rig.put(1, 0, 0, node_status::leaving);
  rig.run(500ms);
  EXPECT_EQ(rig.mesh.feature_count(), 1u);
  EXPECT_EQ(rig.server.header("quarantined_count"), 0u);
}

TEST(Gateway, ANodeOnTopOfAnotherWaitsInQuarantineUntilThereIsRoom) {
  Rig rig;
  rig.put(1, 10, 10);
  rig.run(500ms);
  rig.put(2, 10, 10);
  rig.run(500ms);
  EXPECT_EQ(rig.mesh.node_count(), 1u);
  EXPECT_EQ(rig.server.header("quarantined_count"), 1u);
  EXPECT_EQ(rig.log.count("node 1002 cannot join at (10, 10)"), 1u) << "said once, not each poll";
  rig.put(1, 20, 20);
  rig.run(500ms);
  EXPECT_EQ(rig.mesh.node_count(), 2u);
  EXPECT_EQ(rig.server.header("quarantined_count"), 0u);
}

TEST(Gateway, AFullMeshIsSaidInTheState) {
  Rig rig({}, 2);
  for (std::uint8_t unit = 1; unit <= 3; ++unit) rig.put(unit, unit, unit * unit);
  rig.run(500ms);
  EXPECT_EQ(rig.mesh.node_count(), 2u);
  EXPECT_EQ(rig.server.header("state"), snapshot_state::partial | snapshot_state::budget_hit);
}

TEST(Gateway, ATornReadIsRepeatedAtOnceAndNeverBecomesAPosition) {
  Rig rig;
  rig.put(1, 0, 0);
  rig.run(500ms);
  NodeRegisters torn = encode_node(
      {.serial = Serial{1001}, .position = {99, 99}, .status = node_status::fix_valid}, 1);
  torn[11] = 2;
  rig.bus.set_registers(1, torn);
  const std::uint32_t before = rig.bus.reads[1];
  rig.run(100ms);
  EXPECT_GE(rig.bus.reads[1], before + 4);
  EXPECT_EQ(rig.mesh.position(VertexId{1}), (Position{0, 0}));
  EXPECT_EQ(rig.log.count("unit 1 of yard: torn read"), 1u);
}

struct BadAnswer {
  const char* name;
  NodeRegisters registers;
  const char* logged;
};

NodeRegisters spoilt(std::size_t index, std::uint16_t value) {
  NodeRegisters registers = encode_node(
      {.serial = Serial{1001}, .position = {99, 99}, .status = node_status::fix_valid}, 1);
  registers[index] = value;
  return registers;
}

class GatewayRefuses : public testing::TestWithParam<BadAnswer> {};

TEST_P(GatewayRefuses, ToTakeAPositionFromIt) {
  Rig rig;
  rig.put(1, 0, 0);
  rig.put(2, 9, 9);
  rig.run(500ms);
  rig.bus.set_registers(1, GetParam().registers);
  rig.run(500ms);
  EXPECT_EQ(rig.mesh.position(VertexId{1}), (Position{0, 0}));
  EXPECT_EQ(rig.log.count(GetParam().logged), 1u) << testing::PrintToString(rig.log.lines);
  rig.run(5s);
  EXPECT_EQ(rig.mesh.node_count(), 1u) << "nobody vouches for the node any more";
}

INSTANTIATE_TEST_SUITE_P(
    Answers, GatewayRefuses,
    testing::Values(BadAnswer{"wrong_magic", spoilt(0, 0x4555), "register 0 is not 0x4554"},
                    BadAnswer{"swapped_bytes", spoilt(0, 0x5445), "bytes swapped"},
                    BadAnswer{"wrong_version", spoilt(1, 0x020c), "register 1 is not 0x010C"},
                    BadAnswer{"out_of_range", spoilt(5, 0x0101), "position beyond"}),
    [](const auto& row) { return std::string(row.param.name); });

TEST(Gateway, ExceptionsCostTheUnitItsTurnsOnly) {
  Rig rig;
  rig.put(1, 0, 0);
  rig.put(2, 10, 0);
  rig.run(500ms);
  rig.bus.set_result(1, port::BusResult::exception, 11);
  rig.run(2s);
  EXPECT_EQ(rig.log.count("unit 1 of yard: exception 11: nobody is there, says the converter; look "
                          "at its supply, its cable and its address"),
            1u);
  EXPECT_EQ(rig.server.header("stale_count"), 1u);
  EXPECT_EQ(rig.mesh.node_count(), 2u);
}

TEST(Gateway, AbsentUnitsAreAskedEverLessOften) {
  Rig rig;
  rig.put(1, 0, 0);
  rig.run(10s);
  EXPECT_GE(rig.bus.reads[1], 80u);
  EXPECT_LE(rig.bus.reads[2], 30u);
  EXPECT_GE(rig.bus.reads[2], 20u) << "absent_interval is the longest pause";
}

// All fall silent at once; if they were asked again at once too, they would keep the bus together.
TEST(Gateway, AbsentUnitsAreNotAskedTogether) {
  Rig rig;
  rig.put(1, 0, 0);
  rig.run(2min);
  const auto asked = [&] {
    std::uint32_t sum = 0;
    for (std::uint8_t unit = 2; unit <= 20; ++unit) sum += rig.bus.reads[unit];
    return sum;
  };
  std::uint32_t before = asked();
  for (int turn = 0; turn < 1000; ++turn) {
    rig.run(10ms);
    const std::uint32_t after = asked();
    EXPECT_LE(after - before, 6u) << "of nineteen, by chance";
    before = after;
  }
}

TEST(Gateway, AUnitMayHaveATimeoutOfItsOwn) {
  Rig rig;
  rig.settings.buses[0].devices = {
      {.units = {{.first = 7, .last = 8}}, .profile = node_profile, .timeout = 700ms}};
  rig.run(200ms);
  EXPECT_EQ(rig.bus.timeouts[6], rig.settings.buses[0].timeout);
  EXPECT_EQ(rig.bus.timeouts[7], 700ms);
  EXPECT_EQ(rig.bus.timeouts[8], 700ms);
}

TEST(Gateway, AbsentUnitsNeverTakeTheWholeBus) {
  Rig rig;
  rig.settings.buses.front().outstanding_max = 4;
  rig.settings.buses.front().timeout = 5s;
  rig.bus.outstanding_max = 4;
  rig.settings.poll.absent_interval = 100ms;
  rig.put(1, 0, 0);
  rig.run(30s);  // each absent unit has failed by now
  const std::uint32_t before = rig.bus.reads[1];
  rig.run(10s);
  EXPECT_GE(rig.bus.reads[1], before + 90);
}

TEST(Gateway, AfterALostLinkAllAreAskedWithinAPoll) {
  Rig rig;
  rig.put(1, 0, 0);
  rig.run(500ms);
  rig.bus.link_up = false;
  rig.run(2s);
  EXPECT_EQ(rig.server.header("stale_count"), 1u);
  const std::uint32_t before = rig.bus.reads[1];
  rig.bus.link_up = true;
  rig.run(100ms);
  EXPECT_GT(rig.bus.reads[1], before);
  rig.run(100ms);
  EXPECT_EQ(rig.server.header("stale_count"), 0u);
}

TEST(Gateway, AWrongWordOrderShowsAgainstASerialOfTheConfiguration) {
  Rig rig({feature(1001, 1002)});
  rig.bus.set(
      1,
      {.serial = swap_words(Serial{1001}), .position = {1, 2}, .status = node_status::fix_valid});
  rig.run(2s);
  EXPECT_EQ(rig.mesh.node_count(), 0u);
  EXPECT_EQ(rig.log.count("which is 1001 with its words swapped; set `word_order`"), 1u);
}

TEST(Gateway, TheWordOrderOfABusIsHeeded) {
  Rig rig;
  rig.settings.buses[0].word_order = WordOrder::dcba;
  rig.bus.set_registers(
      1,
      reorder(encode_node(
                  {.serial = Serial{7}, .position = {-5, 6}, .status = node_status::fix_valid}, 1),
              WordOrder::dcba));
  rig.put(2, 0, 0);  // ABCD
  rig.run(1s);
  EXPECT_EQ(rig.mesh.node_count(), 1u);
  EXPECT_EQ(rig.mesh.position(VertexId{1}), (Position{-5, 6}));
  EXPECT_EQ(rig.log.count("unit 2 of yard: register 0 has its bytes swapped"), 1u);
}

// Twenty units on a line that takes one question at a time and is busy all the time.
TEST(Gateway, DeadUnitsOfABusyLineCostTheOthersLittle) {
  const auto polls_of_the_healthy = [](std::uint8_t dead) {
    Rig rig;
    rig.bus.outstanding_max = 1;
    rig.settings.buses[0].outstanding_max = 1;
    rig.settings.poll.interval = 10ms;
    rig.settings.poll.absent_interval = 10ms;
    rig.settings.buses[0].units = {{.first = 1, .last = static_cast<std::uint8_t>(18 + dead)}};
    for (std::uint8_t unit = 1; unit <= 18; ++unit) rig.put(unit, unit * unit, 7 * unit % 11);
    rig.run(100s);
    std::uint32_t reads = 0;
    for (std::uint8_t unit = 1; unit <= 18; ++unit) reads += rig.bus.reads[unit];
    for (std::uint8_t unit = 19; unit <= 18 + dead; ++unit) EXPECT_GT(rig.bus.reads[unit], 5u);
    return reads;
  };
  EXPECT_GT(polls_of_the_healthy(2) * 100, polls_of_the_healthy(0) * 96);
}

TEST(Gateway, AllUnitsOfABusAreBackAtOnceWhenItsCableIs) {
  Rig rig;
  rig.settings.poll.absent_interval = 10min;
  for (std::uint8_t unit = 1; unit <= 10; ++unit) rig.put(unit, unit * unit, unit);
  rig.run(1s);
  for (std::uint8_t unit = 1; unit <= 10; ++unit) rig.bus.silence(unit);
  rig.run(5min);
  EXPECT_EQ(rig.server.header("stale_count"), 10u);
  for (std::uint8_t unit = 1; unit <= 10; ++unit) rig.put(unit, unit * unit, unit);
  rig.run(200ms);  // two polls
  EXPECT_EQ(rig.server.header("stale_count"), 0u);
  EXPECT_EQ(rig.server.header("state"), 0u);
}

TEST(Gateway, DeadUnitsOfAnIdleLineAreAskedAsOftenAsTheyAreDue) {
  Rig rig;
  rig.bus.outstanding_max = 1;
  rig.settings.buses[0].outstanding_max = 1;
  rig.settings.poll.interval = 1s;
  rig.settings.buses[0].units = {{.first = 1, .last = 2}};
  rig.put(1, 0, 0);
  rig.run(60s);
  EXPECT_GE(rig.bus.reads[2], 55u);
}

// A machine that sleeps, a debugger, a disk that hangs: what passes then is no cost of the unit
// that was asked before.
TEST(Gateway, ADeadUnitThatWasAskedBeforeAStandstillIsAskedAfterIt) {
  Rig rig;
  rig.bus.outstanding_max = 1;
  rig.settings.buses[0].outstanding_max = 1;
  rig.settings.poll.interval = 1s;
  rig.settings.buses[0].units = {{.first = 1, .last = 2}};
  rig.put(1, 0, 0);
  rig.run(10s);
  for (const std::uint32_t before = rig.bus.reads[2]; rig.bus.reads[2] == before;) rig.run(10ms);
  rig.clock.pass(5min);
  const std::uint32_t asked = rig.bus.reads[2];
  rig.run(60s);
  EXPECT_GE(rig.bus.reads[2], asked + 55u);
}

}  // namespace
}  // namespace etcm::firmware
