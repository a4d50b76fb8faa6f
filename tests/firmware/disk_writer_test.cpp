// What every disk has in common: when it is written, and what is said of it.
#include "firmware/persist/disk_writer.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "fakes.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

struct ScriptedDisk {
  bool take_result(port::DiskResult& result) {
    if (!news) return false;
    result = {.ok = news->empty(), .why = *news};
    news.reset();
    return true;
  }
  std::optional<std::string> news;  // why it failed; empty: it did not
};

class DiskWriterTest : public testing::Test {
 protected:
  // A write, and how it ends.
  void write(const std::string& why) {
    writer_.mark_dirty();
    ASSERT_TRUE(writer_.is_due(clock_.now()));
    writer_.start(clock_.now());
    disk_.news = why;
    EXPECT_EQ(writer_.hear(disk_, clock_.now()),
              why.empty() ? DiskWriter::Heard::written : DiskWriter::Heard::failed);
    clock_.pass(1min);
  }

  static constexpr DiskMessages messages_{
      .failed = "not kept: ", .unresponsive = "it hangs", .works_again = "it is kept again"};
  SimulatedClock clock_;
  RecordingLog log_;
  ScriptedDisk disk_;
  DiskWriter writer_{messages_, 1min, log_};
};

TEST_F(DiskWriterTest, WritesWhatIsDirtyAtOnceAndThenOnceAnInterval) {
  EXPECT_EQ(writer_.next_deadline(), port::never);
  writer_.mark_dirty();
  EXPECT_TRUE(writer_.is_due(clock_.now()));
  const port::Instant started = clock_.now();
  writer_.start(started);
  writer_.mark_dirty();
  EXPECT_EQ(writer_.next_deadline(), port::never) << "one at a time";
  disk_.news = "";
  writer_.hear(disk_, clock_.now());
  EXPECT_EQ(writer_.next_deadline(), started + 1min);
  writer_.mark_urgent();
  EXPECT_TRUE(writer_.is_due(clock_.now()));
}

TEST_F(DiskWriterTest, WhatStandsThereAlreadyCountsAsWritten) {
  writer_.mark_dirty();
  writer_.skip(clock_.now());
  EXPECT_EQ(writer_.next_deadline(), port::never);
  EXPECT_FALSE(writer_.is_under_way());
  writer_.mark_dirty();
  EXPECT_EQ(writer_.next_deadline(), clock_.now() + 1min);
}

TEST_F(DiskWriterTest, EachReasonIsSaidOnceAndThatItWorksAgain) {
  for (const char* why : {"full", "full", "gone", "gone", "full", "", ""}) write(why);
  EXPECT_EQ(log_.lines, (std::vector<std::string>{"not kept: full; goes on, and tries again",
                                                  "not kept: gone; goes on, and tries again",
                                                  "not kept: full; goes on, and tries again",
                                                  "it is kept again"}));
  EXPECT_FALSE(writer_.is_in_trouble());
}

TEST_F(DiskWriterTest, WhatFailedIsTriedAgainAnIntervalLater) {
  writer_.mark_dirty();
  writer_.start(clock_.now());
  disk_.news = "full";
  writer_.hear(disk_, clock_.now());
  EXPECT_TRUE(writer_.is_failing());
  EXPECT_EQ(writer_.next_deadline(), clock_.now() + 1min);
}

TEST_F(DiskWriterTest, ADiskThatHangsIsSaidOnceAndThatItAnswersAgain) {
  writer_.mark_dirty();
  writer_.start(clock_.now());
  for (int second = 0; second < 60; ++second, clock_.pass(1s)) writer_.hear(disk_, clock_.now());
  EXPECT_EQ(log_.lines, std::vector<std::string>{"it hangs"});
  EXPECT_TRUE(writer_.is_in_trouble());
  EXPECT_FALSE(writer_.is_failing());
  disk_.news = "";
  writer_.hear(disk_, clock_.now());
  EXPECT_EQ(log_.lines.back(), "it is kept again");
  EXPECT_FALSE(writer_.is_in_trouble());
}

}  // namespace
}  // namespace etcm::firmware
