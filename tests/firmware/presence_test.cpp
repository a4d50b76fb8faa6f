// Whose silence counts: neither that of a whole bus nor that of a gateway that did not run. And
// whose position is fresh.
#include "firmware/nodes/presence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "fakes.h"
#include "silence.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

constexpr std::uint16_t silent_bus = snapshot_state::stale | snapshot_state::bus_silent;

TEST(BusSilence, AnUnpluggedBusExpelsNobodyAndIsSaidOnce) {
  Rig rig;
  rig.put_square();
  rig.run(1s);
  for (std::uint8_t unit = 1; unit <= 4; ++unit) rig.bus.silence(unit);
  rig.run(long_silence);
  expect_nobody_left(rig);
  EXPECT_EQ(rig.server.header("node_count"), 4u);
  EXPECT_EQ(rig.server.header("stale_count"), 4u);
  EXPECT_EQ(rig.server.header("silent_bus_count"), 1u);
  EXPECT_EQ(rig.server.header("missing_count"), 0u);
  EXPECT_EQ(rig.server.header("state"), silent_bus);
  EXPECT_EQ(rig.log.count("bus yard: silent for 1 s, none of its 4 nodes answers"), 1u)
      << logged(rig);
  rig.put_square();
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("state"), 0u);
  EXPECT_EQ(rig.log.count("bus yard: answers again, after 300 s"), 1u) << logged(rig);
}

TEST(BusSilence, ABusThatNeverAnsweredIsSilentAfterLeaveAfter) {
  TwoBuses rig;
  rig.put_square();
  rig.run(2900ms);
  EXPECT_EQ(rig.server.header("state"), 0u);
  EXPECT_EQ(rig.log.count("silent"), 0u) << logged(rig);
  rig.run(1s);
  EXPECT_EQ(rig.server.header("state"), snapshot_state::bus_silent);
  EXPECT_EQ(rig.server.header("silent_bus_count"), 1u);
  rig.run(long_silence);
  EXPECT_EQ(rig.log.count("bus gate: silent since the start, none of its units has answered; "), 1u)
      << logged(rig);
  rig.put_other(7, 500, 500);
  rig.run(1s);
  EXPECT_EQ(rig.server.header("state"), 0u);
  EXPECT_EQ(rig.log.count("bus gate: answers, for the first time since the start"), 1u)
      << logged(rig);
}

// It does not ask before answers to an earlier run can come no more.
TEST(BusSilence, IsNoneBeforeABusAsks) {
  Rig rig;
  rig.bus.clear_at = rig.clock.now() + 10s;
  rig.run(10s);
  EXPECT_EQ(rig.log.count("silent"), 0u) << logged(rig);
  EXPECT_EQ(rig.gateway->presence().silent_bus_count(), 0u);
  EXPECT_TRUE(rig.bus.reads.empty());
  rig.run(4s);
  EXPECT_EQ(rig.log.count("bus yard: silent since the start"), 1u) << logged(rig);
  rig.put_square();
  rig.run(1s);
  EXPECT_EQ(rig.server.header("node_count"), 4u);
}

TEST(BusSilence, ABusThatOnlyLooksForNodesMayHaveNone) {
  Rig rig;
  rig.settings.buses[0].scan = std::exchange(rig.settings.buses[0].units, {});
  rig.settings.buses[0].assign = {{.first = 30, .last = 31}};
  rig.run(long_silence);
  EXPECT_EQ(rig.log.count("silent"), 0u) << logged(rig);
  EXPECT_EQ(rig.gateway->presence().silent_bus_count(), 0u);
}

// What is said to be done about it fits what is known of the cause.
TEST(BusSilence, TheCureFitsTheCause) {
  const auto cure = [](auto&& break_it) {
    Rig rig;
    rig.settings.buses[0].link = *port::parse_endpoint("192.0.2.5:502");
    break_it(rig);
    rig.run(4s);
    const auto line = std::find_if(rig.log.lines.begin(), rig.log.lines.end(), [](auto& text) {
      return text.starts_with("bus yard: silent since the start");
    });
    return line == rig.log.lines.end() ? logged(rig) : line->substr(line->find(';') + 2);
  };
  EXPECT_EQ(cure([](Rig& rig) {
              rig.bus.link_up = false;
              rig.bus.why_no_link = "mill:502: Name or service not known; correct the name";
            }),
            "mill:502: Name or service not known; correct the name");
  EXPECT_EQ(cure([](Rig&) {}),
            "connected, but nothing answers; check the line behind it, and the power and addresses "
            "of its units");
  EXPECT_EQ(cure([](Rig& rig) { rig.settings.buses[0].link = port::SerialLine{}; }),
            "check its cable, speed and parity, and the power and addresses of its units");
  EXPECT_EQ(cure([](Rig& rig) { rig.bus.set_result(7, port::BusResult::exception, 2); }),
            "its units answer, but with nothing sound; each has an alarm of its own, or a line in "
            "the log, that says why");
  EXPECT_EQ(cure([](Rig& rig) { rig.bus.set_result(7, port::BusResult::bad_answer); }),
            "its units answer, but with nothing sound; each has an alarm of its own, or a line in "
            "the log, that says why");
  EXPECT_EQ(cure([](Rig& rig) {
              for (std::uint8_t unit = 1; unit <= 20; ++unit) {
                rig.bus.set_result(unit, port::BusResult::exception, 0x0b);
              }
            }),
            "the converter says that nobody is there; check the line behind it, and the power and "
            "addresses of its units");
}

TEST(BusSilence, NeitherDoesALinkThatIsLost) {
  Rig rig;
  rig.put_square();
  rig.run(1s);
  rig.bus.link_up = false;
  rig.run(long_silence);
  expect_nobody_left(rig);
  EXPECT_EQ(rig.server.header("state"), silent_bus);
  rig.bus.link_up = true;
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("state"), 0u);
}

// A converter whose line is cut answers for each unit.
TEST(BusSilence, NorAConverterThatHasNobodyBehindIt) {
  for (const std::uint8_t exception : {std::uint8_t{0x0a}, std::uint8_t{0x0b}}) {
    Rig rig;
    rig.put_square();
    rig.run(1s);
    for (std::uint8_t unit = 1; unit <= 20; ++unit) {
      rig.bus.set_result(unit, port::BusResult::exception, exception);
    }
    rig.run(long_silence);
    expect_nobody_left(rig);
    EXPECT_EQ(rig.server.header("state"), silent_bus);
  }
}

// Or it answers what it has in its memory.
TEST(BusSilence, NorOneThatAnswersWithZeros) {
  Rig rig;
  rig.put_square();
  rig.run(1s);
  for (std::uint8_t unit = 1; unit <= 20; ++unit) rig.bus.set_registers(unit, NodeRegisters{});
  rig.run(long_silence);
  expect_nobody_left(rig);
  EXPECT_EQ(rig.server.header("state"), silent_bus);
}

TEST(BusSilence, ABusWithASingleNodeKeepsIt) {
  Rig rig;
  rig.put(1, 0, 0);
  rig.run(1s);
  rig.bus.silence(1);
  rig.run(long_silence);
  expect_nobody_left(rig);
  EXPECT_EQ(rig.mesh.node_count(), 1u);
  EXPECT_EQ(rig.server.header("state"), silent_bus);
}

TEST(BusSilence, TheLastOfABusStays) {
  Rig rig;
  rig.put_square();
  rig.run(1s);
  for (std::uint8_t unit = 1; unit <= 4; ++unit) {
    rig.bus.silence(unit);
    rig.run(10s);
  }
  EXPECT_EQ(rig.mesh.node_count(), 1u);
  EXPECT_EQ(rig.server.header("missing_count"), 3u);
  EXPECT_EQ(rig.server.header("state"), silent_bus | snapshot_state::missing);
}

TEST(BusSilence, WhoWasSilentAlreadyHasItsWholeTimeAnew) {
  for (const port::Duration outage : std::array<port::Duration, 3>{2s, 10s, 5min}) {
    Rig rig;
    rig.put_square();
    rig.run(1s);
    rig.bus.silence(1);
    rig.run(2800ms);
    for (std::uint8_t unit = 2; unit <= 4; ++unit) rig.bus.silence(unit);
    rig.run(outage);
    rig.put_square();
    rig.bus.silence(1);
    rig.run(2800ms);
    expect_nobody_left(rig);
    rig.run(500ms);
    EXPECT_EQ(rig.log.count("node 1001 is missing"), 1u) << logged(rig);
    EXPECT_EQ(rig.server.header("missing_count"), 1u);
  }
}

TEST(BusSilence, AFewLostAnswersOfAllAreNoSilenceOfAny) {
  Rig rig;
  rig.put_square();
  rig.run(1s);
  // The bus is away for less than it takes to call it silent, again and again.
  for (int i = 0; i < 100; ++i) {
    rig.bus.link_up = false;
    rig.run(900ms);
    rig.bus.link_up = true;
    rig.run(300ms);
  }
  expect_nobody_left(rig);
  EXPECT_EQ(rig.log.count("bus yard: silent"), 0u) << logged(rig);
}

// A leave_after little longer than it takes to call the bus silent: an outage that is not called so
// must not count either.
TEST(BusSilence, AShortOneIsAddedToNobodysOwn) {
  Rig rig;
  rig.settings.poll.leave_after = 1500ms;
  rig.put_square();
  rig.run(1s);
  rig.bus.silence(1);
  rig.run(800ms);
  rig.bus.link_up = false;
  rig.run(900ms);
  rig.bus.link_up = true;
  rig.run(300ms);
  expect_nobody_left(rig);
  rig.run(1s);
  EXPECT_EQ(rig.log.count("node 1001 is missing"), 1u) << logged(rig);
}

TEST(BusSilence, OfABusThatComesBackInPartTheRestIsMissing) {
  Rig rig;
  rig.put_square();
  rig.run(1s);
  for (std::uint8_t unit = 1; unit <= 4; ++unit) rig.bus.silence(unit);
  rig.run(long_silence);
  rig.put(2, 100, 0);
  rig.put(4, 0, 100);
  rig.run(2900ms);
  expect_nobody_left(rig);
  EXPECT_EQ(rig.server.header("state"), snapshot_state::stale);
  rig.run(500ms);
  EXPECT_EQ(rig.mesh.node_count(), 2u);
  EXPECT_EQ(rig.server.header("state"), snapshot_state::missing);
  EXPECT_EQ(rig.log.count("node 1001 is missing: unit 1 of yard, silent for 303 s"), 1u)
      << logged(rig);
}

TEST(BusSilence, EachBusIsJudgedForItself) {
  TwoBuses rig;
  rig.put_square();
  for (std::uint8_t unit = 1; unit <= 3; ++unit) rig.put_other(unit, 300 + unit * unit, 7 * unit);
  rig.run(1s);
  EXPECT_EQ(rig.server.header("node_count"), 7u);
  for (std::uint8_t unit = 1; unit <= 4; ++unit) rig.bus.silence(unit);
  rig.other.silence(2);
  rig.run(10s);
  EXPECT_EQ(rig.server.header("node_count"), 6u);
  EXPECT_EQ(rig.server.header("stale_count"), 4u);
  EXPECT_EQ(rig.server.header("missing_count"), 1u);
  EXPECT_EQ(rig.log.count("node 2002 is missing: unit 2 of gate"), 1u) << logged(rig);
  EXPECT_EQ(rig.log.count("bus yard: silent"), 1u);
  EXPECT_EQ(rig.log.count("bus gate: silent"), 0u);
  rig.other.link_up = false;
  rig.run(10s);
  EXPECT_EQ(rig.server.header("node_count"), 6u);
  EXPECT_EQ(rig.server.header("silent_bus_count"), 2u);
}

TEST(BusSilence, ABusWhoseOnlyNodeAskedToLeaveIsNot) {
  Rig rig;
  rig.put(1, 0, 0);
  rig.run(1s);
  rig.put(1, 0, 0, node_status::leaving);
  rig.run(1s);
  rig.bus.silence(1);
  rig.run(10s);
  expect_nobody_left(rig);
  EXPECT_EQ(rig.gateway->presence().silent_bus_count(), 0u);
  EXPECT_EQ(rig.gateway->nodes().records()[0].is_known(), false);
}

TEST(GatewayPause, ExpelsNobody) {
  for (const port::Duration pause : std::array<port::Duration, 4>{2s, 4s, 8s, 5min}) {
    Rig rig;
    rig.put_square();
    rig.run(1s);
    rig.bus.silence(1);  // who answers no more has answered just before
    rig.run(2s);
    rig.clock.pass(pause);
    rig.run(800ms);
    expect_nobody_left(rig);
    EXPECT_EQ(rig.log.count("bus yard: silent"), 0u) << logged(rig);
    EXPECT_EQ(rig.server.header("stale_count"), 1u);
    rig.run(3s);
    EXPECT_EQ(rig.log.count("node 1001 is missing"), 1u) << "it is silent for itself";
    EXPECT_EQ(rig.server.header("node_count"), 3u);
  }
}

TEST(GatewayPause, ThatComesAgainAndAgainExpelsNobody) {
  Rig rig;
  rig.put_square();
  rig.run(1s);
  for (int i = 0; i < 200; ++i) {
    rig.clock.pass(8s);
    rig.run(200ms);
  }
  expect_nobody_left(rig);
  EXPECT_EQ(rig.gateway->presence().silent_bus_count(), 0u);
}

TEST(GatewayPause, WhileABusIsSilentAddsNothing) {
  Rig rig;
  rig.put_square();
  rig.run(1s);
  for (std::uint8_t unit = 1; unit <= 4; ++unit) rig.bus.silence(unit);
  rig.run(10s);
  rig.clock.pass(1h);
  rig.run(10s);
  rig.put_square();
  rig.run(1s);
  expect_nobody_left(rig);
  EXPECT_EQ(rig.gateway->presence().silent_bus_count(), 0u);
}

// What is not fresh must not be said to be, whoever's fault it is.
TEST(GatewayPause, MakesPositionsStaleUntilTheNodesAnswer) {
  Rig rig;
  rig.put_square();
  rig.run(1s);
  for (std::uint8_t unit = 1; unit <= 4; ++unit) rig.bus.silence(unit);
  rig.clock.pass(8s);
  rig.run(300ms);
  EXPECT_EQ(rig.server.header("stale_count"), 4u);
  EXPECT_GE(rig.server.header("oldest_age_ms"), 8000u);
  rig.put_square();
  rig.run(300ms);
  EXPECT_EQ(rig.server.header("stale_count"), 0u);
}

TEST(WithoutAFix, APositionGrowsOldAndIsShownSo) {
  Rig rig;
  rig.put_square();
  rig.run(1s);
  rig.put(1, 0, 0, 0);
  rig.run(30s);
  EXPECT_EQ(rig.server.header("node_count"), 4u) << "it answers, so it stays";
  EXPECT_EQ(rig.server.header("stale_count"), 1u);
  EXPECT_EQ(rig.server.header("state"), snapshot_state::stale);
  expect_nobody_left(rig);
  const auto& vertices = rig.gateway->snapshot().vertices;
  EXPECT_EQ(std::count_if(vertices.begin(), vertices.end(),
                          [](const SnapshotVertex& vertex) { return vertex.lacks_fix; }),
            1);
  rig.put(6, 20, 30);  // another generation
  rig.run(500ms);
  EXPECT_GE(rig.server.header("oldest_age_ms"), 30'000u);
  rig.put(1, 0, 0);
  rig.run(500ms);
  EXPECT_EQ(rig.gateway->presence().silent_bus_count(), 0u);
  EXPECT_LE(rig.server.header("oldest_age_ms"), 500u);
}

TEST(WithoutAFix, ItsLossAndItsReturnAreALineEach) {
  Rig rig;
  rig.put_square();
  rig.run(1s);
  rig.put(1, 0, 0, 0);
  rig.run(30s);
  rig.put(1, 0, 0);
  rig.run(5s);
  EXPECT_EQ(rig.log.count("node 1001 has no fix: unit 1 of yard answers, and has told no position "
                          "for 1 s; it stays where it was"),
            1u)
      << logged(rig);
  EXPECT_EQ(rig.log.count("node 1001 has a fix again, after 30 s"), 1u) << logged(rig);
  EXPECT_EQ(rig.log.count(" fix"), 2u) << logged(rig);
}

TEST(WithoutAFix, OneThatNeverHadOneIsSaidToo) {
  Rig rig;
  rig.put(1, 0, 0, 0);
  rig.run(5s);
  rig.put(1, 0, 0);
  rig.run(1s);
  EXPECT_EQ(rig.log.count("node 1001 has no fix: unit 1 of yard answers, and has told no position "
                          "yet"),
            1u)
      << logged(rig);
  EXPECT_EQ(rig.log.count("node 1001 has a fix"), 1u) << logged(rig);
  EXPECT_EQ(rig.log.count(" again"), 0u) << logged(rig);
}

// One that falls silent has other troubles.
TEST(WithoutAFix, ASilentNodeIsNotSaidToHaveNone) {
  Rig rig;
  rig.put_square();
  rig.run(1s);
  rig.bus.silence(1);
  rig.run(2s);
  rig.put(1, 0, 0);
  rig.run(2s);
  EXPECT_EQ(rig.log.count(" fix"), 0u) << logged(rig);
}

TEST(WithoutAFix, ASilentNodeThatAnswersIsNotFreshYet) {
  Rig rig;
  rig.put_square();
  rig.run(1s);
  rig.bus.silence(1);
  rig.run(2s);
  EXPECT_EQ(rig.server.header("stale_count"), 1u);
  rig.put(1, 0, 0, 0);
  rig.run(2s);
  EXPECT_EQ(rig.server.header("stale_count"), 1u);
}

}  // namespace
}  // namespace etcm::firmware
