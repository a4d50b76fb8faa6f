// When units are asked, on a machine that is late: simulated time, steps at odd moments.
#include <gtest/gtest.h>

#include <array>

#include "fakes.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

// Asked every 100 ms; a step every 37 ms is late by 18 ms on average.
class Cadence : public testing::Test {
 protected:
  Cadence() {
    for (std::uint8_t unit = 1; unit <= 20; ++unit) rig_.put(unit, unit * 100, unit % 7);
    rig_.run(300ms);
  }
  void run(port::Duration duration, port::Duration step) {
    for (port::Duration passed{}; passed < duration; passed += step) {
      rig_.gateway->step(rig_.clock.now());
      rig_.clock.pass(step);
    }
  }
  std::uint32_t asked(std::uint8_t unit) { return rig_.bus.reads[unit]; }

  Rig rig_;
};

TEST_F(Cadence, BeingLateDoesNotAddUp) {
  const std::uint32_t before = asked(7);
  run(10s, 37ms);
  EXPECT_GE(asked(7) - before, 99u);
  EXPECT_LE(asked(7) - before, 101u);
}

TEST_F(Cadence, AStallIsNotMadeUpFor) {
  rig_.clock.pass(30s);
  const std::uint32_t before = asked(7);
  run(100ms, 10ms);
  EXPECT_EQ(asked(7) - before, 1u);
  run(1s, 10ms);
  EXPECT_EQ(asked(7) - before, 11u);
}

// One question each, then the old times again.
TEST_F(Cadence, AShortStallMovesNothing) {
  const std::uint32_t before = asked(7);
  rig_.clock.pass(90ms);
  run(910ms, 10ms);
  EXPECT_EQ(asked(7) - before, 10u);
}

TEST_F(Cadence, ATornReadKeepsItsTime) {
  NodeRegisters torn = encode_node({.serial = Serial{1007}, .position = {5, 5}}, 7);
  torn.back() = 8;
  rig_.bus.set_registers(7, torn);
  const std::uint32_t before = asked(7);
  run(30ms, 10ms);
  rig_.put(7, 700, 0);
  run(9970ms, 37ms);
  EXPECT_LE(asked(7) - before, 104u);
  EXPECT_GE(asked(7) - before, 99u);
}

class Polling : public Cadence {};

TEST_F(Polling, ALostAnswerIsAskedForAgainOnce) {
  const std::uint32_t before = asked(7);
  rig_.bus.silence(7);
  run(30ms, 10ms);
  rig_.put(7, 700, 0);
  run(70ms, 10ms);
  EXPECT_EQ(asked(7) - before, 2u) << "within the interval";
  EXPECT_EQ(rig_.gateway->poller().failures(UnitIndex{6}), 0u);
  run(1s, 10ms);
  EXPECT_EQ(asked(7) - before, 12u) << "and then at the old times";
  // Once, where the answer to that is missing too.
  rig_.bus.silence(7);
  run(400ms, 10ms);
  EXPECT_EQ(asked(7) - before, 12u + 4u);
}

// Two of one address, say, of which the second answers always as late.
TEST_F(Polling, WhoIsTalkedOverAtItsTimeIsAskedAtAnother) {
  const std::uint32_t before = asked(7);
  while (asked(7) == before) run(10ms, 10ms);
  const std::uint32_t begin = asked(7);
  for (int interval = 0; interval < 100; ++interval) {
    run(80ms, 10ms);
    rig_.bus.silence(7);
    run(20ms, 10ms);
    rig_.put(7, 700, 0);
  }
  EXPECT_LE(asked(7) - begin, 100u + 4u);
  EXPECT_GE(asked(7) - begin, 99u);
}

// Behind a converter its answers came too late for the others' sake: it is there.
TEST_F(Polling, WhoWasHeldUpIsAskedAsOneThatIsThere) {
  rig_.bus.silence(7);
  run(5s, 10ms);
  ASSERT_GT(rig_.gateway->poller().failures(UnitIndex{6}), 3u);
  rig_.put(7, 700, 0);
  const std::uint32_t before = asked(7);
  rig_.bus.held_up = 7;
  run(50ms, 10ms);
  EXPECT_EQ(asked(7) - before, 1u);
  EXPECT_EQ(rig_.gateway->poller().failures(UnitIndex{6}), 0u);
  run(1s, 10ms);
  EXPECT_GE(asked(7) - before, 10u);
}

TEST_F(Polling, WhoNeverAnsweredIsNotAskedAgainAtOnce) {
  Rig rig;
  rig.put(1, 0, 0);
  rig.run(300ms);
  EXPECT_EQ(rig.bus.reads[2], 3u);
}

// Dead units wait for minutes there until they are asked; one that lost a frame is not one of them.
TEST_F(Polling, ALostAnswerIsAskedForAgainOnABusyLineToo) {
  Rig rig;
  rig.bus.outstanding_max = 1;
  BusSettings& bus = rig.settings.buses[0];
  bus.outstanding_max = 1;
  bus.timeout = 100ms;
  bus.units = {{.first = 1, .last = 50}};
  rig.settings.poll.interval = 10ms;
  rig.settings.poll.absent_interval = 1s;
  rig.settings.poll.leave_after = 10s;
  for (std::uint8_t unit = 1; unit <= 20; ++unit) rig.put(unit, unit * unit, 7 * unit % 11);
  rig.run(60s);
  const std::uint32_t before = rig.bus.reads[7];
  rig.bus.silence(7);
  while (rig.bus.reads[7] == before) rig.run(10ms);
  rig.put(7, 49, 5);
  rig.run(200ms);
  EXPECT_GE(rig.bus.reads[7], before + 2);
  // Units that lose every other answer cost the others no more than that share of the line.
  const auto polls = [&](bool is_lossy) {
    const std::uint32_t begin = rig.bus.reads[1];
    for (int step = 0; step < 6000; ++step) {
      for (std::uint8_t unit = 11; unit <= 12; ++unit) {
        const bool is_lost = is_lossy && rig.bus.reads[unit] % 2 == 1;
        is_lost ? rig.bus.silence(unit) : rig.put(unit, unit * unit, 7 * unit % 11);
      }
      rig.run(10ms);
    }
    return rig.bus.reads[1] - begin;
  };
  const std::uint32_t without = polls(false);
  EXPECT_GE(polls(true) * 100, without * 80);
}

// Each question takes a step, and twenty units do not fit into an interval: all have as many.
TEST_F(Cadence, ALineThatIsTooSlowIsFair) {
  rig_.bus.outstanding_max = 1;
  run(20s, 10ms);
  std::array<std::uint32_t, 21> before{};
  for (std::uint8_t unit = 1; unit <= 20; ++unit) before[unit] = asked(unit);
  run(20s, 10ms);
  for (std::uint8_t unit = 1; unit <= 20; ++unit) {
    EXPECT_GE(asked(unit) - before[unit], 95u) << "unit " << int{unit};
    EXPECT_LE(asked(unit) - before[unit], 105u) << "unit " << int{unit};
  }
}

// A line that takes one question at a time, with a unit that does not answer: polls of another one
// in two minutes, where the bus is silent for so long after each wait in vain.
std::uint32_t polls_beside_an_absent_unit(port::Duration interval, port::Duration silence) {
  Rig rig;
  rig.bus.outstanding_max = 1;
  rig.bus.silence_after_timeout = silence;
  rig.settings.buses[0].outstanding_max = 1;
  rig.settings.buses[0].units = {{.first = 1, .last = 2}};
  rig.settings.poll.interval = rig.settings.poll.absent_interval = interval;
  rig.put(1, 0, 0);
  rig.run(2min);
  EXPECT_GE(rig.bus.reads[2], 3u) << "it may come back";
  return rig.bus.reads[1];
}

TEST(SilenceForAnAbsentUnit, IsWithinItsShareOfABusyLine) {
  EXPECT_GT(polls_beside_an_absent_unit(10ms, 1s) * 100,
            polls_beside_an_absent_unit(10ms, 0s) * 96);
}

TEST(SilenceForAnAbsentUnit, DoesNotComeInTheWayOfThoseAboutToBeAsked) {
  EXPECT_GE(polls_beside_an_absent_unit(500ms, 1s), 220u);
}

}  // namespace
}  // namespace etcm::firmware
