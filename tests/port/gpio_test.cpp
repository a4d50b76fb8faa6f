// Digital inputs: what bounce does not do, and what a lost event does not hide.
#include <gtest/gtest.h>

#include "gpio/debounce.h"
#include "gpio/line_place.h"

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
