// Who fell silent for itself is missing: known, shown and saved, until it returns or is dismissed.
#include <gtest/gtest.h>

#include <algorithm>

#include "etcm/audit.h"
#include "fakes.h"
#include "memory_store.h"
#include "silence.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

TEST(Missing, IsKnownUntilItReturns) {
  Rig rig({feature(1001, 1002)});
  rig.put_square();
  rig.run(1s);
  rig.bus.silence(1);
  rig.run(long_silence);
  EXPECT_EQ(rig.server.header("node_count"), 3u) << "the mesh has those who talk";
  EXPECT_EQ(rig.server.header("missing_count"), 1u);
  EXPECT_EQ(rig.server.header("quarantined_count"), 0u);
  EXPECT_EQ(rig.server.header("state"), snapshot_state::missing | snapshot_state::partial);
  EXPECT_EQ(rig.log.count("node 1001 is missing: unit 1 of yard, silent for 3 s; it counts as"), 1u)
      << logged(rig);
  rig.put(1, 0, 0);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("node_count"), 4u);
  EXPECT_EQ(rig.server.header("missing_count"), 0u);
  EXPECT_EQ(rig.server.header("state"), 0u);
  EXPECT_EQ(rig.log.count("node 1001 is back: it answers again, after 300 s"), 1u) << logged(rig);
  EXPECT_TRUE(audit(rig.mesh));
}

TEST(Missing, ComesBackAtAnotherUnitOrBus) {
  TwoBuses rig;
  rig.put_square();
  rig.put_other(1, 300, 7);
  rig.run(1s);
  rig.bus.silence(1);
  rig.bus.silence(2);
  rig.run(10s);
  EXPECT_EQ(rig.server.header("missing_count"), 2u);
  rig.other.set(9, {.serial = Serial{1001}, .position = {0, 0}, .status = node_status::fix_valid});
  rig.bus.set(15, {.serial = Serial{1002}, .position = {100, 0}, .status = node_status::fix_valid});
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("state"), 0u) << logged(rig);
  EXPECT_EQ(rig.server.header("node_count"), 5u);
  EXPECT_EQ(rig.log.count("two nodes"), 0u);
}

TEST(Missing, IsNotWhoMovesToAnotherUnitOrBus) {
  TwoBuses rig;
  rig.put_square();
  rig.put_other(1, 300, 7);
  rig.run(1s);
  rig.bus.silence(1);
  rig.other.set(9, {.serial = Serial{1001}, .position = {0, 0}, .status = node_status::fix_valid});
  rig.run(10s);
  expect_nobody_left(rig);
  EXPECT_EQ(rig.server.header("state"), 0u);
  // Silent there, it is silent on that bus.
  rig.other.silence(9);
  rig.run(10s);
  EXPECT_EQ(rig.log.count("node 1001 is missing: unit 9 of gate"), 1u) << logged(rig);
}

TEST(Missing, IsWhoWasReplacedAndIsNowhere) {
  Rig rig;
  rig.put_square();
  rig.run(1s);
  rig.bus.set(1, {.serial = Serial{77}, .position = {1, 1}, .status = node_status::fix_valid});
  rig.run(10s);
  EXPECT_EQ(rig.log.count("node 1001 is missing: unit 1 of yard"), 1u) << logged(rig);
  EXPECT_EQ(rig.server.header("node_count"), 4u);
  EXPECT_EQ(rig.server.header("missing_count"), 1u);
}

TEST(Missing, FreesItsUnitForAnotherNodeAtOnce) {
  Rig rig;
  rig.put_square();
  rig.run(1s);
  rig.bus.silence(1);
  rig.run(10s);
  rig.bus.set(1, {.serial = Serial{77}, .position = {1, 1}, .status = node_status::fix_valid});
  rig.run(500ms);
  EXPECT_EQ(rig.log.count("node 77 joined"), 1u) << logged(rig);
  EXPECT_EQ(rig.server.header("missing_count"), 1u);
}

TEST(Missing, IsDismissedByWord) {
  Rig rig;
  rig.put_square();
  rig.run(1s);
  rig.bus.silence(1);
  rig.bus.silence(2);
  rig.run(10s);
  EXPECT_EQ(rig.server.header("missing_count"), 2u);
  rig.update_settings();
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("missing_count"), 2u) << "a reload dismisses nobody";
  EXPECT_FALSE(rig.gateway->dismiss(Serial{1003})) << "it is here";
  EXPECT_FALSE(rig.gateway->dismiss(Serial{4711})) << "nobody knows it";
  EXPECT_TRUE(rig.gateway->dismiss(Serial{1001}));
  EXPECT_EQ(rig.gateway->dismiss_all(rig.clock.now()), 1u);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("missing_count"), 0u);
  EXPECT_EQ(rig.server.header("state"), 0u);
  EXPECT_EQ(rig.log.count("is no longer missed: dismissed"), 2u) << logged(rig);
  // Whoever falls silent after it is missing again, and a dismissed one may come back.
  rig.bus.silence(3);
  rig.put(1, 0, 0);
  rig.run(10s);
  EXPECT_EQ(rig.server.header("missing_count"), 1u);
  EXPECT_EQ(rig.server.header("node_count"), 2u);
  EXPECT_EQ(rig.log.count("node 1001 joined"), 2u);
}

TEST(Missing, IsNotWhoAskedToLeaveBeforeOrAfter) {
  Rig rig;
  rig.put_square();
  rig.run(1s);
  rig.put(1, 0, 0, node_status::fix_valid | node_status::leaving);
  rig.run(1s);
  rig.bus.silence(1);
  rig.bus.silence(2);
  rig.run(10s);
  EXPECT_EQ(rig.log.count("node 1001 is missing"), 0u) << logged(rig);
  EXPECT_EQ(rig.server.header("missing_count"), 1u);
  rig.put(2, 100, 0, node_status::leaving);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("missing_count"), 0u);
  EXPECT_EQ(rig.server.header("state"), 0u);
  rig.bus.silence(2);
  rig.run(10s);
  EXPECT_EQ(rig.server.header("state"), 0u);
  EXPECT_EQ(rig.server.header("node_count"), 2u);
}

TEST(Missing, IsNoLongerInQuarantine) {
  Rig rig;
  rig.put_square();
  rig.put(5, 0, 0);  // where node 1001 is
  rig.run(1s);
  EXPECT_EQ(rig.server.header("quarantined_count"), 1u);
  rig.bus.silence(5);
  rig.run(10s);
  EXPECT_EQ(rig.server.header("quarantined_count"), 0u);
  EXPECT_EQ(rig.server.header("state"), snapshot_state::missing);
  // Its place is free now, and it does not take it.
  rig.put(1, 7, 7);
  rig.run(5s);
  EXPECT_EQ(rig.server.header("node_count"), 4u);
}

TEST(Missing, IsWhoNeverToldItsPlaceToo) {
  Rig rig;
  rig.put_square();
  rig.put(5, 0, 0, 0);
  rig.run(1s);
  EXPECT_EQ(rig.server.header("waiting_count"), 1u);
  EXPECT_EQ(rig.server.header("state"), snapshot_state::partial);
  rig.bus.silence(5);
  rig.run(10s);
  EXPECT_EQ(rig.server.header("waiting_count"), 0u);
  EXPECT_EQ(rig.server.header("state"), snapshot_state::missing);
}

// A fence runs from node 1 over node 5 to node 2, between two posts. Without node 5 it would need a
// Steiner vertex, for which there is no room.
void put_fence(Rig& rig) {
  rig.put(1, 0, 0);
  rig.put(2, 100, 0);
  rig.put(3, 50, 10);
  rig.put(4, 50, -10);
  rig.put(5, 50, 0);
}

TEST(Missing, IsWhomTheMeshCannotDoWithoutToo) {
  Rig rig({feature(1001, 1002)}, 5);
  put_fence(rig);
  rig.run(1s);
  ASSERT_EQ(rig.server.header("features_active"), 1u);
  rig.bus.silence(5);
  rig.run(10s);
  EXPECT_EQ(rig.server.header("node_count"), 5u);
  EXPECT_EQ(rig.server.header("missing_count"), 1u);
  EXPECT_EQ(rig.server.header("state"), snapshot_state::missing | snapshot_state::partial |
                                            snapshot_state::stale | snapshot_state::budget_hit);
  EXPECT_FALSE(rig.gateway->dismiss(Serial{1005}));
  EXPECT_EQ(rig.gateway->dismiss_all(rig.clock.now()), 0u);
  rig.run(1s);
  EXPECT_EQ(rig.server.header("missing_count"), 1u) << "the mesh still has it";
  rig.put(5, 50, 0);
  rig.run(1s);
  EXPECT_EQ(rig.server.header("state"), 0u);
}

TEST(Missing, IsNotWhoAskedToLeaveAndCouldNot) {
  Rig rig({feature(1001, 1002)}, 5);
  put_fence(rig);
  rig.run(1s);
  rig.put(5, 50, 0, node_status::fix_valid | node_status::leaving);
  rig.run(1s);
  ASSERT_EQ(rig.log.count("node 1005 cannot leave"), 1u) << logged(rig);
  rig.bus.silence(5);
  rig.run(10s);
  EXPECT_EQ(rig.server.header("missing_count"), 0u) << logged(rig);
  // It goes as soon as there is room.
  rig.bus.silence(3);
  rig.run(10s);
  EXPECT_EQ(rig.log.count("node 1005 left"), 1u);
  EXPECT_EQ(rig.server.header("missing_count"), 1u);
  EXPECT_EQ(rig.server.header("node_count"), 3u);
}

// Sixteen nodes more than there are units, and a quarter, are known; then the one that has been
// missing for longest is given up for one that answers.
TEST(Missing, GivesWayToThoseWhoAnswerWhereThereIsNoRoom) {
  Rig rig;
  const auto known = static_cast<std::uint32_t>(20 + 5 + 16);
  rig.put(2, 50, 50);
  for (std::uint32_t serial = 1; serial < known; ++serial) {
    rig.bus.set(1, {.serial = Serial{serial},
                    .position = {static_cast<std::int32_t>(serial), 0},
                    .status = node_status::fix_valid});
    rig.run(5s);
  }
  EXPECT_EQ(rig.server.header("missing_count"), known - 2);
  EXPECT_EQ(rig.log.count("is no longer missed"), 0u);
  for (std::uint32_t serial = 101; serial <= 103; ++serial) {
    rig.bus.set(1,
                {.serial = Serial{serial}, .position = {-5, 0}, .status = node_status::fix_valid});
    rig.run(5s);
    EXPECT_EQ(rig.log.count("node " + std::to_string(serial) + " joined"), 1u);
  }
  EXPECT_EQ(rig.server.header("missing_count"), known - 2);
  EXPECT_EQ(rig.log.count("node 1 is no longer missed, though it did not come back"), 1u)
      << logged(rig);
  EXPECT_EQ(rig.log.count("is no longer missed"), 3u) << logged(rig);
  EXPECT_EQ(rig.log.count("too many nodes without a unit"), 0u);
  // It is told at once, though the other one has no place that would change the mesh.
  rig.bus.set(1, {.serial = Serial{104}, .position = {}, .status = 0});
  for (int i = 0; i < 100 && rig.log.count("is no longer missed") < 4; ++i) rig.run(10ms);
  EXPECT_EQ(rig.server.header("missing_count"), known - 3);
}

class MissingOverARestart : public testing::Test {
 protected:
  std::unique_ptr<Rig> make_rig() {
    auto rig = std::make_unique<Rig>();
    rig->settings.state = StateSettings{.folder = "/state", .interval = 1s};
    rig->store = &store_;
    return rig;
  }
  MemoryStore store_;
};

TEST_F(MissingOverARestart, StaysSo) {
  const auto before = make_rig();
  before->put_square();
  before->put(5, 9, 9, 0);  // it never tells its place
  before->run(1s);
  before->bus.silence(1);
  before->bus.silence(5);
  before->run(100s);
  before->gateway->finish(before->clock.now());
  const auto after = make_rig();
  for (std::uint8_t unit = 2; unit <= 4; ++unit) after->put(unit, unit * unit, 90);
  after->start();
  after->gateway->restore(after->clock.now());
  EXPECT_EQ(after->server.header("missing_count"), 2u);
  EXPECT_EQ(after->server.header("state"), snapshot_state::missing | snapshot_state::stale);
  EXPECT_EQ(after->log.count("2 nodes are missing since before the restart: the longest node 1001, "
                             "unit 1 of yard, silent for 100 s at least"),
            1u)
      << logged(*after);
  after->run(10s);
  EXPECT_EQ(after->server.header("missing_count"), 2u);
  EXPECT_EQ(after->server.header("node_count"), 3u);
  after->put(1, 0, 0);
  after->put(5, 9, 9);
  after->run(1s);
  EXPECT_EQ(after->server.header("state"), 0u);
  EXPECT_EQ(after->server.header("node_count"), 5u);
}

TEST_F(MissingOverARestart, DoesNotWhereItWasDismissed) {
  const auto before = make_rig();
  before->put_square();
  before->run(1s);
  before->bus.silence(1);
  before->run(10s);
  EXPECT_TRUE(before->gateway->dismiss(Serial{1001}));
  before->run(2s);
  const auto after = make_rig();
  after->start();
  after->gateway->restore(after->clock.now());
  EXPECT_EQ(after->server.header("missing_count"), 0u);
}

// The gateway was switched off for a day.
TEST_F(MissingOverARestart, CountsTheTimeInWhichTheGatewayDidNotRun) {
  const auto before = make_rig();
  FollowingWallClock wall(before->clock);
  before->wall_clock = &wall;
  before->put_square();
  before->run(1s);
  before->bus.silence(1);
  before->run(100s);
  before->gateway->finish(before->clock.now());
  const auto after = make_rig();
  before->clock.pass(24h);
  after->wall_clock = &wall;
  after->start();
  after->gateway->restore(after->clock.now());
  const NodeRecord* const node = after->gateway->nodes().find(Serial{1001});
  ASSERT_NE(node, nullptr);
  ASSERT_TRUE(node->is_missing);
  EXPECT_GE(after->clock.now() - node->heard_at, 24h + 99s);
  EXPECT_LE(after->clock.now() - node->heard_at, 24h + 102s);
  EXPECT_GE(after->clock.now() - node->positioned_at, 24h + 99s);
}

// Many units are asked in vain first, each for the time of half a node's patience; and a branch is
// out, whose nodes are asked one after the other too.
TEST_F(MissingOverARestart, IsNobodyWhoWasNotAskedYet) {
  const auto make = [&] {
    auto rig = make_rig();
    BusSettings& bus = rig->settings.buses[0];
    bus.units = {{.first = 1, .last = 247}};
    bus.timeout = rig->settings.poll.timeout = 200ms;
    rig->bus.outstanding_max = bus.outstanding_max = 1;
    for (std::uint8_t unit = 40; unit < 80; ++unit) rig->put(unit, 7 * unit, unit * unit % 101);
    return rig;
  };
  const auto before = make();
  before->run(2min);
  ASSERT_EQ(before->mesh.node_count(), 40u);
  before->gateway->finish(before->clock.now());
  const auto after = make();
  for (std::uint8_t unit = 40; unit < 60; ++unit) after->bus.silence(unit);
  after->start();
  after->gateway->restore(after->clock.now());
  after->run(2 * after->settings.poll.leave_after);
  for (std::uint8_t unit = 60; unit < 80; ++unit) {
    EXPECT_GT(after->bus.reads[unit], 0u) << unit;
    EXPECT_EQ(after->log.count("node " + std::to_string(1000 + unit) + " is missing"), 0u) << unit;
  }
  after->run(2min);
  EXPECT_EQ(after->mesh.node_count(), 20u) << "the others are, by then";
}

// It fell silent before the restart, and is missing after it.
class SilentOverARestart : public MissingOverARestart {
 protected:
  static constexpr port::Duration leave_after = 1min;

  // By how much the silence is told too long, of one that began before `end` ended the run.
  template <class End>
  port::Duration silence_after(End end) {
    const auto before = make_rig();
    before->settings.poll.leave_after = leave_after;
    FollowingWallClock wall(before->clock);
    before->wall_clock = &wall;
    before->put_square();
    before->run(30min);
    const port::Instant silent_at = before->clock.now();
    before->bus.silence(1);
    end(*before);
    before->clock.pass(3s);
    const port::Duration passed = before->clock.now() - silent_at;
    const auto after = make_rig();
    after->settings.poll.leave_after = leave_after;
    after->wall_clock = &wall;
    after->put_square();
    after->bus.silence(1);
    after->start();
    const port::Instant started = after->clock.now();
    after->gateway->restore(started);
    const NodeRecord* const node = after->gateway->nodes().find(Serial{1001});
    EXPECT_NE(node, nullptr);
    EXPECT_FALSE(node->is_missing);
    after->run(leave_after + 10s);
    EXPECT_TRUE(node->is_missing) << logged(*after);
    return started - node->heard_at - passed;
  }
};

TEST_F(SilentOverARestart, IsSoSinceItsLastAnswer) {
  const port::Duration off = silence_after([](Rig& rig) {
    rig.run(1s);
    rig.gateway->finish(rig.clock.now());
  });
  EXPECT_LE(abs(off), 2s) << off / 1ms;
}

// Nothing was saved at the end; that it was silent had been before.
TEST_F(SilentOverARestart, IsSoAfterAPowerFailureToo) {
  const port::Duration off =
      silence_after([](Rig& rig) { rig.run(rig.settings.poll.stale_after + 3s); });
  EXPECT_LE(abs(off), 2s) << off / 1ms;
}

// Of what the disk says of half an hour ago nothing follows: it answered long after that.
TEST_F(SilentOverARestart, CountsFromTheStartWhereNothingWasSavedOfIt) {
  const port::Duration off = silence_after([](Rig& rig) { rig.run(200ms); });
  EXPECT_LE(off, 0s) << off / 1ms;
  EXPECT_GE(off, -4s) << off / 1ms;
}

// Nothing else changes for hours, and then the power fails.
TEST_F(MissingOverARestart, IsKnownWithinTheHourSinceWhen) {
  const auto before = make_rig();
  before->put_square();
  before->run(1s);
  before->bus.silence(1);
  before->run(5h, 200ms);
  const std::size_t saves = store_.saves;
  before->run(5h, 200ms);
  EXPECT_GE(store_.saves, saves + 4);
  EXPECT_LE(store_.saves, saves + 6);
  const auto after = make_rig();
  after->start();
  after->gateway->restore(after->clock.now());
  const auto records = after->gateway->nodes().records();
  const auto missing = std::find_if(records.begin(), records.end(),
                                    [](const NodeRecord& node) { return node.is_missing; });
  ASSERT_NE(missing, records.end());
  EXPECT_GE(after->clock.now() - missing->heard_at, 9h - 2min);
}

// Restored where nobody answers, and where the bus is gone from the configuration.
TEST_F(MissingOverARestart, IsNobodyOfABusThatIsSilent) {
  const auto before = make_rig();
  before->put_square();
  before->put(20, 7, 7);
  before->run(2s);
  const auto after = make_rig();
  after->settings.buses[0].units = {{.first = 1, .last = 4}};
  after->start();
  after->gateway->restore(after->clock.now());
  after->run(long_silence);
  EXPECT_EQ(after->mesh.node_count(), 4u);
  EXPECT_EQ(after->log.count("bus yard: silent since the start, none of its 4 nodes"), 1u)
      << logged(*after);
  EXPECT_EQ(after->log.count("node 1020 is missing: on no bus of this configuration"), 1u);
  after->put_square();
  after->run(1s);
  EXPECT_EQ(after->log.count("bus yard: answers, for the first time since the start"), 1u);
  EXPECT_EQ(after->server.header("state"), snapshot_state::missing);
}

}  // namespace
}  // namespace etcm::firmware
