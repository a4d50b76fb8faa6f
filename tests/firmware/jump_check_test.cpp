// Which positions of a device count, by how far it can have come.
#include "firmware/polling/jump_check.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;
using Verdict = JumpCheck::Verdict;

class Jumps : public testing::Test {
 protected:
  Verdict judge(std::int32_t x, std::int32_t y, port::Duration after = 1s) {
    now_ += after;
    return check_.judge({.x = x, .y = y}, speed_max_, now_);
  }
  // The first position is told twice.
  void begin_at(std::int32_t x, std::int32_t y) {
    EXPECT_EQ(judge(x, y), Verdict::ask_again);
    EXPECT_EQ(judge(x, y, 20ms), Verdict::take);
  }
  double speed_max_ = 10;
  port::Instant now_{1h};
  JumpCheck check_;
};

TEST_F(Jumps, WhatCanFollowCounts) {
  begin_at(1'000'000, -5);
  EXPECT_EQ(judge(1'000'010, -5), Verdict::take);
  EXPECT_EQ(judge(1'000'016, 3), Verdict::take);
  EXPECT_EQ(judge(1'000'116, 3, 10s), Verdict::take);
}

// It may be torn like any other.
TEST_F(Jumps, TheFirstPositionCountsOnceItIsToldTwice) {
  EXPECT_EQ(judge(7'000'000, 7'000'000), Verdict::ask_again);
  EXPECT_EQ(judge(3, 4, 20ms), Verdict::drop);
  begin_at(3, 4);
}

TEST_F(Jumps, ADeviceThatStandsStillCountsAtOnceHoweverSoon) {
  begin_at(5, 5);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(judge(5 + i % 2, 6 - i % 2, 0s), Verdict::take);
}

TEST_F(Jumps, OneThatIsToldTwiceCounts) {
  begin_at(0, 0);
  EXPECT_EQ(judge(5000, 0), Verdict::ask_again);
  EXPECT_EQ(judge(5000, 0, 20ms), Verdict::take);
  EXPECT_EQ(judge(5003, 0), Verdict::take) << "and it is what the next one is measured from";
}

TEST_F(Jumps, OneThatIsToldOnceDoesNot) {
  begin_at(0, 0);
  EXPECT_EQ(judge(5000, 0), Verdict::ask_again);
  EXPECT_EQ(judge(1, 0, 20ms), Verdict::take_instead);
  EXPECT_EQ(judge(2, 0), Verdict::take);
}

TEST_F(Jumps, TwoPlacesThatDoNotAgreeAreNeither) {
  begin_at(0, 0);
  EXPECT_EQ(judge(5000, 0), Verdict::ask_again);
  EXPECT_EQ(judge(0, 5000, 20ms), Verdict::drop);
  EXPECT_EQ(judge(5000, 0, 20ms), Verdict::ask_again) << "what was dropped is no evidence";
  EXPECT_EQ(judge(5000, 0, 20ms), Verdict::take);
}

// It may have come from there meanwhile.
TEST_F(Jumps, TheSecondMayHaveMovedAsFarAsItCan) {
  begin_at(0, 0);
  EXPECT_EQ(judge(5000, 0), Verdict::ask_again);
  EXPECT_EQ(judge(5009, 0, 1s), Verdict::take);
}

TEST_F(Jumps, AfterALongSilenceItMayBeFarAway) {
  begin_at(0, 0);
  EXPECT_EQ(judge(36'000, 0, 1h), Verdict::take);
  EXPECT_EQ(judge(-16'777'216, -16'777'216, 24h * 365 * 100), Verdict::take);
}

TEST_F(Jumps, SpeedsAtTheirLimitsAreJudged) {
  speed_max_ = 1e18;
  begin_at(-16'777'216, -16'777'216);
  EXPECT_EQ(judge(16'777'216, 16'777'216, 1us), Verdict::take);
  speed_max_ = 1e-9;
  EXPECT_EQ(judge(0, 0), Verdict::ask_again);
  EXPECT_EQ(judge(0, 0), Verdict::take);
}

// Each tear is half old and half new; whatever comes, no torn place counts, and it never stays
// behind for more than one question.
TEST_F(Jumps, NoTearCountsAndNoMoveIsLost) {
  std::minstd_rand random(4);
  std::int32_t x = 0, y = 0;
  begin_at(x, y);
  for (int i = 0; i < 20'000; ++i) {
    const std::int32_t old_x = x;
    const bool is_carried = random() % 10 == 0;
    const auto far = [&] { return static_cast<std::int32_t>(random() % 1'000'000) + 2'000; };
    x += is_carried ? far() - (x > 0 ? 1'500'000 : 0) : static_cast<std::int32_t>(random() % 5);
    y += is_carried ? far() - (y > 0 ? 1'500'000 : 0) : static_cast<std::int32_t>(random() % 5);
    if (is_carried && random() % 2 == 0) {
      // Read while it changed.
      ASSERT_NE(judge(old_x, y), Verdict::take);
    }
    Verdict verdict = judge(x, y);
    int questions = 1;
    while (verdict == Verdict::ask_again || verdict == Verdict::drop) {
      verdict = judge(x, y, 20ms);
      ++questions;
    }
    ASSERT_LE(questions, 3);
  }
}

}  // namespace
}  // namespace etcm::firmware
