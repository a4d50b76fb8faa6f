// Digital inputs: what bounce does not do, and what a lost event does not hide.
#include <gtest/gtest.h>

#include "gpio/chip_offset.h"
#include "gpio/debounce.h"
#ifdef ETCM_WITH_GPIO
#include "gpio/gpio_lines.h"
#include "peer.h"
#endif

namespace etcm::port {
namespace {

using namespace std::chrono_literals;

constexpr Instant start{1h};

TEST(Debounce, ALevelCountsOnceItHasStoodStill) {
  Debounce input(false, 20ms);
  input.sample(true, true, start);
  EXPECT_FALSE(input.level());
  EXPECT_EQ(input.settles_at(), start + 20ms);
  input.sample(true, false, start + 19ms);
  EXPECT_FALSE(input.level());
  input.sample(true, false, start + 20ms);
  EXPECT_TRUE(input.level());
  EXPECT_EQ(input.settles_at(), never);
}

TEST(Debounce, BounceStartsTheWaitAgain) {
  Debounce input(false, 20ms);
  for (Duration at{}; at < 100ms; at += 10ms) {
    input.sample(true, true, start + at);
    EXPECT_FALSE(input.level());
  }
  input.sample(true, false, start + 110ms);
  EXPECT_TRUE(input.level());
}

TEST(Debounce, APulseShorterThanThePeriodIsNone) {
  Debounce input(true, 20ms);
  input.sample(false, true, start);
  input.sample(true, true, start + 5ms);
  EXPECT_EQ(input.settles_at(), never);
  input.sample(true, false, start + 1s);
  EXPECT_TRUE(input.level());
}

TEST(Debounce, ALevelThatChangedWithoutAnEventIsFoundWhenItIsRead) {
  Debounce input(false, 20ms);
  input.sample(true, false, start);
  input.sample(true, false, start + 20ms);
  EXPECT_TRUE(input.level());
}

TEST(Debounce, WithoutAPeriodEachLevelCounts) {
  Debounce input(false, 0ms);
  input.sample(true, true, start);
  EXPECT_TRUE(input.level());
}

#ifdef ETCM_WITH_GPIO
TEST(GpioLines, ThatAreNotThereCostNothingAndAreTriedAgain) {
  EventLoop loop;
  KeptLog log;
  const std::vector<LineRequest> requests{{.name = "ETCM-NO-SUCH-ALERT", .use = LineUse::input},
                                          {.name = "ETCM-NO-SUCH-LED", .use = LineUse::output}};
  GpioLines lines(loop, log, requests, 20ms);
  ASSERT_EQ(log.lines.size(), 2u);
  EXPECT_EQ(log.lines[1],
            "gpio line ETCM-NO-SUCH-LED was not found; gpioinfo lists the lines there are and "
            "their names; goes on without it, and tries again");
  EXPECT_FALSE(lines.is_active(DigitalLine{0}));
  lines.set_active(DigitalLine{1}, true);
  Instant now = start;
  for (int i = 0; i < 5; ++i) {
    lines.advance(now);
    EXPECT_EQ(lines.next_deadline(), now + GpioLines::retry_interval);
    now = lines.next_deadline();
  }
  EXPECT_EQ(log.lines.size(), 2u) << "said once";
}
#endif

TEST(LinePlace, IsANameOrAChipAndAnOffset) {
  EXPECT_FALSE(parse_chip_offset("ALERT"));
  EXPECT_FALSE(parse_chip_offset("gpiochip0:"));
  EXPECT_FALSE(parse_chip_offset("gpiochip0:x"));
  EXPECT_FALSE(parse_chip_offset(":4"));
  const auto found = parse_chip_offset("9030000.pl061:4");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->chip, "9030000.pl061");
  EXPECT_EQ(found->offset, 4u);
}

}  // namespace
}  // namespace etcm::port
