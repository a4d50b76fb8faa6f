// The board's lines: what the LED says, when the watchdog is fed, what the alert does.
#include "firmware/gateway/board_io.h"

#include <gtest/gtest.h>

#include <map>

#include "fakes.h"
#include "firmware/publish/snapshot.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

class LinesInHand final : public port::DigitalIo {
 public:
  bool is_active(port::DigitalLine input) const override { return levels.at(input.index); }
  void set_active(port::DigitalLine output, bool active) override { levels[output.index] = active; }
  void advance(port::Instant) override {}
  port::Instant next_deadline() const override { return port::never; }
  std::map<int, bool> levels{{0, false}, {1, false}, {2, false}, {3, false}};
};

constexpr BoardLines all_lines{.alert = port::DigitalLine{0},
                               .join_button = port::DigitalLine{1},
                               .status_led = port::DigitalLine{2},
                               .watchdog = port::DigitalLine{3}};

struct GatewayWithBoard {
  GatewayWithBoard() {
    rig_.settings.buses[0].units = {{.first = 1, .last = 20}, {.first = 247, .last = 247}};
    rig_.settings.poll.interval = 100ms;
    rig_.settings.poll.absent_interval = 1min;
    rig_.settings.poll.leave_after = 10min;
    rig_.settings.poll.stale_after = 10min;
  }

  // Runs both, and counts the times a line went up.
  void run(port::Duration duration) {
    if (!board_io_) {
      rig_.start();
      board_io_.emplace(lines_, all_lines, *rig_.gateway);
    }
    for (port::Duration passed{}; passed < duration; passed += 10ms) {
      const std::map<int, bool> before = lines_.levels;
      board_io_->step(rig_.clock.now());
      rig_.gateway->step(rig_.clock.now());
      for (const auto& [line, level] : lines_.levels) rises_[line] += level && !before.at(line);
      EXPECT_GT(board_io_->next_deadline(), rig_.clock.now());
      rig_.clock.pass(10ms);
    }
  }

  Rig rig_;
  LinesInHand lines_;
  std::optional<BoardIo> board_io_;
  std::map<int, int> rises_;
};

class BoardOfAGateway : public testing::Test, protected GatewayWithBoard {};

TEST_F(BoardOfAGateway, AnAlertBringsANewNodeIntoTheMeshAtOnce) {
  rig_.put(1, 0, 0);
  run(5min);  // the default address has failed often: it is hardly asked any more
  rig_.put(247, 5, 6);
  run(500ms);
  EXPECT_EQ(rig_.gateway->node_count(), 1u);
  lines_.levels[0] = true;
  run(200ms);
  EXPECT_EQ(rig_.gateway->node_count(), 2u);
}

TEST_F(BoardOfAGateway, SoDoesTheButton) {
  rig_.put(1, 0, 0);
  run(5min);
  rig_.put(247, 5, 6);
  lines_.levels[1] = true;
  run(200ms);
  EXPECT_EQ(rig_.gateway->node_count(), 2u);
}

TEST_F(BoardOfAGateway, WhileTheAlertIsUpTheDefaultAddressIsAskedAgainAndAgain) {
  rig_.put(1, 0, 0);
  run(5min);
  const std::uint32_t before = rig_.bus.reads[247];
  lines_.levels[0] = true;
  run(5s);
  EXPECT_GE(rig_.bus.reads[247], before + 5);
  EXPECT_LE(rig_.bus.reads[247], before + 7);
}

struct Polls {
  std::uint32_t of_the_sound = 0;
  std::uint32_t of_the_dead = 0;
  std::uint32_t of_newcomers = 0;
};

// On a serial line that is always busy, where each question in vain costs the others its timeout.
// The alert is up and down in turn for so long.
Polls polls_with_alert(port::Duration up, port::Duration down) {
  GatewayWithBoard busy;
  Rig& rig = busy.rig_;
  rig.bus.outstanding_max = 1;
  rig.settings.buses[0].outstanding_max = 1;
  rig.settings.buses[0].timeout = 100ms;
  rig.settings.poll.interval = 10ms;
  rig.settings.poll.absent_interval = 1s;
  for (std::uint8_t unit = 1; unit <= 18; ++unit) rig.put(unit, unit * unit, 7 * unit % 11);
  busy.run(10s);
  rig.bus.reads.clear();
  for (port::Duration passed{}; passed < 100s; passed += up + down) {
    busy.lines_.levels[0] = true;
    busy.run(up);
    busy.lines_.levels[0] = false;
    busy.run(down);
  }
  Polls polls{.of_the_dead = rig.bus.reads[19] + rig.bus.reads[20],
              .of_newcomers = rig.bus.reads[247]};
  for (std::uint8_t unit = 1; unit <= 18; ++unit) polls.of_the_sound += rig.bus.reads[unit];
  return polls;
}

// A floating pin: each edge is more than the debounce away from the one before.
TEST_F(BoardOfAGateway, AFlutteringAlertCostsTheOthersLittle) {
  const Polls calm = polls_with_alert(0ms, 100s);
  const Polls fluttering = polls_with_alert(30ms, 30ms);
  EXPECT_GE(fluttering.of_the_sound * 100, calm.of_the_sound * 95);
  EXPECT_GE(fluttering.of_the_dead * 2, calm.of_the_dead) << "they may come back";
  EXPECT_GE(fluttering.of_newcomers, 20u);
}

TEST_F(BoardOfAGateway, SoDoesOneThatIsStuck) {
  const Polls calm = polls_with_alert(0ms, 100s);
  const Polls stuck = polls_with_alert(100s, 0ms);
  EXPECT_GE(stuck.of_the_sound * 100, calm.of_the_sound * 95);
  EXPECT_GE(stuck.of_the_dead * 2, calm.of_the_dead);
  EXPECT_GE(stuck.of_newcomers, 20u);
}

// Where nobody is kept waiting it is asked every second.
TEST_F(BoardOfAGateway, OnAnIdleLineAnAlertIsHeardEverySecond) {
  rig_.bus.outstanding_max = 1;
  rig_.settings.buses[0].outstanding_max = 1;
  rig_.settings.buses[0].units = {{.first = 1, .last = 1}, {.first = 247, .last = 247}};
  rig_.settings.poll.interval = 500ms;
  rig_.put(1, 0, 0);
  run(5min);
  const std::uint32_t before = rig_.bus.reads[247];
  lines_.levels[0] = true;
  run(10s);
  EXPECT_GE(rig_.bus.reads[247], before + 10);
  EXPECT_LE(rig_.bus.reads[247], before + 12);
}

TEST_F(BoardOfAGateway, TheLedShowsTheState) {
  run(1min);
  // A round of five flashes takes 9 * 150 ms + 900 ms.
  EXPECT_NEAR(rises_[2], 5 * 60.0 / 2.25, 6) << "no nodes";
  rig_.put(1, 0, 0);
  run(70s);
  rises_.clear();
  run(1min);
  EXPECT_NEAR(rises_[2], 60.0 / 1.05, 2) << "all well";
}

TEST(BoardIo, OfSeveralStatesTheHighestIsShown) {
  using namespace snapshot_state;
  EXPECT_EQ(flashes_of(0, 3), 1u);
  EXPECT_EQ(flashes_of(partial, 3), 2u);
  EXPECT_EQ(flashes_of(partial | stale, 3), 3u);
  EXPECT_EQ(flashes_of(partial | missing, 3), 3u);
  EXPECT_EQ(flashes_of(bus_silent, 3), 3u);
  EXPECT_EQ(flashes_of(partial | stale | budget_hit, 3), 4u);
  EXPECT_EQ(flashes_of(partial | stale | budget_hit, 0), 5u);
}

TEST_F(BoardOfAGateway, TheWatchdogIsFedWhileTheLoopTurns) {
  run(10s);
  EXPECT_EQ(rises_[3], 10);
}

}  // namespace
}  // namespace etcm::firmware
