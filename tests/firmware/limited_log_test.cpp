// LimitedLog: noise is cut short, and whoever reads sees each distinct problem and how often it
// was.
#include "firmware/logging/limited_log.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "fakes.h"
#include "firmware/logging/text_line.h"
#include "support/allocation_watch.h"
#include "support/utf8_check.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;
using port::Level;

class LimitedLogTest : public testing::Test {
 protected:
  SimulatedClock clock_;
  RecordingLog written_;
  LimitedLog log_{written_, clock_};
};

TEST_F(LimitedLogTest, WritesTheFirstOfAKindAndCountsTheRest) {
  for (int i = 0; i < 42; ++i) {
    log_.write(Level::warning,
               "unit 7 of yard: answered too late, after " + std::to_string(i) + " ms");
  }
  EXPECT_EQ(written_.lines.size(), LimitedLog::lines_free);
  EXPECT_EQ(written_.lines.front(), "unit 7 of yard: answered too late, after 0 ms");
  clock_.pass(990s);
  log_.write(Level::warning, "unit 7 of yard: answered too late, after 9 ms");
  ASSERT_EQ(written_.lines.size(), LimitedLog::lines_free + 2);
  EXPECT_EQ(written_.lines[5],
            "unit 7 of yard: answered too late, after 41 ms [left out: 37 like this in the last 17 "
            "min]");
  EXPECT_EQ(written_.lines[6], "unit 7 of yard: answered too late, after 9 ms");
}

TEST_F(LimitedLogTest, TellsApartWhatLinesAreAbout) {
  // 300 units flap, each with two troubles; one line of a kind may hide no other.
  for (int round = 0; round < 20; ++round) {
    for (int unit = 1; unit <= 300; ++unit) {
      const std::string name = "unit " + std::to_string(unit) + " of 10.0.0.1:502: ";
      log_.write(Level::warning, name + "no answer in time");
      log_.write(Level::warning, name + "exception " + std::to_string(round));
      clock_.pass(1ms);
    }
  }
  for (int unit = 1; unit <= 300; ++unit) {
    const std::string name = "unit " + std::to_string(unit) + " of 10.0.0.1:502: ";
    EXPECT_GE(written_.count(name + "no answer"), 1u);
    EXPECT_GE(written_.count(name + "exception"), 1u);
  }
}

TEST_F(LimitedLogTest, DetailsMakeNoNewKind) {
  for (int i = 0; i < 50; ++i) {
    log_.write(Level::info, "node 1003 moved from (" + std::to_string(-i) + ", 4) to (5, " +
                                std::to_string(i) + "): generation " + std::to_string(i * 7) +
                                ", 0 Steiner vertices added, " + std::to_string(i) + ".5 us");
  }
  EXPECT_EQ(written_.lines.size(), LimitedLog::lines_free);
}

// Ten thousand nodes that all move are one pattern, whatever they are called.
TEST_F(LimitedLogTest, NamesMakeNoNewPattern) {
  for (int node = 1000; node < 5000; ++node) {
    log_.write(Level::info, "node " + std::to_string(node) + " '" +
                                std::string(1, static_cast<char>('a' + node % 26)) + "'s well " +
                                std::to_string(node) + "' left (silent): generation 7");
  }
  EXPECT_LE(written_.lines.size(), LimitedLog::pattern_lines_free);
  log_.write(Level::info, "node 7 'well' has a fix");
  EXPECT_EQ(written_.count("has a fix"), 1u) << "another pattern";
}

TEST_F(LimitedLogTest, ANightOfFlappingTakesFewLines) {
  // Every 20 s for eight hours.
  for (int i = 0; i < 1440; ++i) {
    log_.write(Level::info, "node 12 joined at (5, 6): generation " + std::to_string(i));
    log_.write(Level::info, "node 12 left (silent): generation " + std::to_string(i));
    clock_.pass(20s);
    if (i == 700) {
      log_.write(Level::error, "node 13: another trouble");
      EXPECT_EQ(written_.lines.back(), "node 13: another trouble");
    }
  }
  EXPECT_LE(written_.lines.size(), 2u * 25u + 1u);
  EXPECT_GE(written_.lines.size(), 2u * 15u) << "it goes on, and so does the telling";
}

TEST_F(LimitedLogTest, NoiseThatHasStoppedIsToldAndForgiven) {
  for (int i = 0; i < 10; ++i) log_.write(Level::warning, "yard: link lost");
  clock_.pass(20min);
  // Whatever is written next brings it out.
  for (std::size_t i = 0; i < LimitedLog::kinds_max; ++i) log_.write(Level::info, "other");
  EXPECT_EQ(written_.count("yard: link lost [left out: 5 like this in the last 20 min]"), 1u);
  clock_.pass(1h);
  const std::size_t before = written_.count("yard: link lost");
  for (int i = 0; i < 10; ++i) log_.write(Level::warning, "yard: link lost");
  EXPECT_EQ(written_.count("yard: link lost"), before + LimitedLog::lines_free);
}

TEST_F(LimitedLogTest, FlushTellsEverything) {
  for (int i = 0; i < 7; ++i) log_.write(Level::warning, "yard: link lost");
  log_.flush();
  log_.flush();
  EXPECT_EQ(written_.count("[left out: 2 like this"), 1u);
}

TEST_F(LimitedLogTest, TheSameWordsAtAnotherLevelAreAnotherKind) {
  for (int i = 0; i < 7; ++i) log_.write(Level::warning, "yard: trouble");
  log_.write(Level::error, "yard: trouble");
  EXPECT_EQ(written_.lines.size(), LimitedLog::lines_free + 1);
}

TEST_F(LimitedLogTest, LinesMayBeEmptyLongOrOdd) {
  const std::string longest(100'000, '7');
  for (int i = 0; i < 8; ++i) {
    log_.write(Level::info, "");
    log_.write(Level::info, longest);
    log_.write(Level::info, "(");
    log_.write(Level::info, ": ");
    log_.write(Level::info, "(1");
    log_.write(Level::info, std::string_view("a\0b", 3));
  }
  log_.flush();
  EXPECT_EQ(written_.count("7... [left out: 3 like this"), 1u);
}

// Counts without taking memory.
class CountingLog final : public port::Log {
 public:
  void write(Level, std::string_view line) override {
    ++lines;
    constexpr std::string_view mark = "[left out: ";
    const std::size_t at = line.find(mark);
    if (at == std::string_view::npos) {
      ++written;
    } else {
      left_out += static_cast<std::uint64_t>(std::atoll(line.data() + at + mark.size()));
    }
    is_last_alarm = line.starts_with("unit 7 of yard: no answer in time");
  }
  std::uint64_t lines = 0;
  std::uint64_t written = 0;   // as they came
  std::uint64_t left_out = 0;  // as other lines tell
  bool is_last_alarm = false;
};

// So many nodes move all the time, far more than kinds can be told apart.
class ManySubjects : public testing::TestWithParam<int> {
 protected:
  // All of them, once.
  void move_all() {
    std::array<char, 120> text;
    for (int node = 1; node <= GetParam(); ++node) {
      const int size = std::snprintf(
          text.data(), text.size(), "node %d moved from (%d, -4) to (5, %d): generation %llu", node,
          node % 37, node % 11, static_cast<unsigned long long>(sent_));
      log_.write(Level::info, {text.data(), static_cast<std::size_t>(size)});
      ++sent_;
    }
  }
  bool alarm() {
    ++sent_;
    log_.write(Level::warning, "unit 7 of yard: no answer in time");
    return counted_.is_last_alarm;
  }

  SimulatedClock clock_;
  CountingLog counted_;
  LimitedLog log_{counted_, clock_};
  std::uint64_t sent_ = 0;
};

TEST_P(ManySubjects, WriteNoMoreThanTheBoundOfTheirPatternAndNoneIsLost) {
  const auto hour = [&] {
    for (int i = 0; i < 30; ++i) {
      move_all();
      clock_.pass(2min);
    }
  };
  const test::AllocationWatch watch;
  hour();
  EXPECT_GE(counted_.lines, std::min<std::uint64_t>(LimitedLog::pattern_lines_free,
                                                    static_cast<std::uint64_t>(GetParam())));
  EXPECT_LE(counted_.lines,
            LimitedLog::pattern_lines_free + 2 * LimitedLog::pattern_lines_noisy + 3);
  const std::uint64_t first = counted_.lines;
  hour();
  hour();
  EXPECT_LE(counted_.lines - first, 3 * (LimitedLog::pattern_lines_noisy + 1));
  log_.flush();
  EXPECT_EQ(counted_.written + counted_.left_out, sent_);
  EXPECT_EQ(watch.allocations(), 0u);
}

TEST_P(ManySubjects, HideNoOtherTrouble) {
  for (int i = 0; i < 10; ++i) {
    move_all();
    clock_.pass(30s);
  }
  EXPECT_TRUE(alarm()) << "at once";
  // It comes and goes: that is noise as well, whatever the others do.
  const std::uint64_t before = counted_.written;
  for (int i = 0; i < 60; ++i) {
    move_all();
    alarm();
    clock_.pass(1s);
  }
  EXPECT_LE(counted_.written - before,
            std::uint64_t{LimitedLog::pattern_lines_noisy} + LimitedLog::pattern_lines_free / 2);
  clock_.pass(3h);
  EXPECT_TRUE(alarm());
  log_.flush();
  EXPECT_EQ(counted_.written + counted_.left_out, sent_);
}

TEST_P(ManySubjects, AreEachSaidWhereTheyAreQuietOtherwise) {
  // A node a minute: nothing here is noise.
  std::uint64_t written = 0;
  for (int node = 1; node <= std::min(GetParam(), 3000); ++node) {
    log_.write(Level::warning, "node " + std::to_string(node) + " left (silent)");
    EXPECT_EQ(counted_.written, ++written);
    clock_.pass(1min);
  }
}

INSTANTIATE_TEST_SUITE_P(LimitedLog, ManySubjects, testing::Values(700, 1600, 10'000));

TEST(LimitedLogPatterns, MoreThanItCanKeepAreBoundedTogetherAndNoneIsLost) {
  SimulatedClock clock;
  CountingLog counted;
  LimitedLog log(counted, clock);
  constexpr std::uint64_t patterns = 20 * LimitedLog::patterns_max;
  constexpr std::uint64_t rounds = 40;
  // Words of letters alone, each a pattern of its own.
  const auto word = [](std::uint64_t number) {
    std::string text;
    for (; number > 0; number /= 26) text += static_cast<char>('a' + number % 26);
    return text;
  };
  for (std::uint64_t round = 0; round < rounds; ++round) {
    for (std::uint64_t i = 1; i <= patterns; ++i) log.write(Level::warning, word(i) + ": trouble");
    clock.pass(1s);
  }
  EXPECT_LE(counted.lines, LimitedLog::patterns_max * rounds + LimitedLog::pattern_lines_free);
  log.flush();
  EXPECT_EQ(counted.written + counted.left_out, rounds * patterns);
}

TEST(LimitedLogMemory, IsTakenAtTheStart) {
  const SimulatedClock clock;
  CountingLog counted;
  LimitedLog log(counted, clock);
  const test::AllocationWatch watch;
  for (int i = 0; i < 1000; ++i) log.write(Level::warning, "unit 7 of yard: no answer in time");
  log.flush();
  EXPECT_EQ(watch.allocations(), 0u);
  EXPECT_EQ(counted.lines, LimitedLog::lines_free + 1);
}

TEST_F(LimitedLogTest, WhatWasLeftOutIsCutBetweenCharacters) {
  for (std::size_t before = 108; before < 118; ++before) {
    const std::string line = std::string(before, 'y') + "\u20ac\u20ac\u20ac";
    for (int i = 0; i < 9; ++i) log_.write(Level::warning, line);
  }
  log_.flush();
  EXPECT_EQ(written_.count("left out"), 10u);
  EXPECT_EQ(written_.count("... [left out"), 8u);  // two fit whole
  for (const std::string& line : written_.lines) EXPECT_TRUE(test::is_utf8(line)) << line;
}

TEST(TextLineTest, IsCutBetweenCharactersAndEndsThere) {
  for (std::size_t before = 470; before < 482; ++before) {
    TextLine line;
    line << std::string(before, 'y') << "\u20ac\u20ac\u20ac\u20ac"
         << "z" << 7;
    EXPECT_TRUE(test::is_utf8(line.view())) << before;
    EXPECT_EQ(line.view().find('z'), std::string_view::npos) << before;
  }
}

}  // namespace
}  // namespace etcm::firmware
