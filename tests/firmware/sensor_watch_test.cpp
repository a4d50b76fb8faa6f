// Sensors that a gateway polls, and one that drifts away from the others.
#include "firmware/readings/sensor_watch.h"

#include <gtest/gtest.h>

#include <string>

#include "measuring.h"
#include "memory_store.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

class SetWallClock final : public port::WallClock {
 public:
  std::int64_t milliseconds() const override { return 1000 * seconds_; }
  void set(std::int64_t seconds) { seconds_ = seconds; }
  void pass(port::Duration time) { seconds_ += time / 1s; }

 private:
  std::int64_t seconds_ = 1'800'000'000;
};

class WatchedSensors : public Measuring {
 protected:
  static constexpr std::uint8_t first = 2, last = 17;

  void SetUp() override {
    std::string text = R"(
[[profile]]
name = "tank"
[[profile.reading]]
name = "level"
unit = "m"
value = { register = 3, type = "i16", scale = "0.001", none = 32767 }
[mesh]
vertices_max = 100
[poll]
interval = "20s"
timeout = "1s"
absent_interval = "20s"
stale_after = "2min"
leave_after = "60min"
[[bus]]
tcp = "127.0.0.1:502"
[[bus.device]]
units = "2-17"
profile = "tank"
)";
    for (int unit = first; unit <= last; ++unit) {
      text += "[[node]]\nunit = " + std::to_string(unit) + "\nx = " + std::to_string(x_of(unit)) +
              "\ny = " + std::to_string(y_of(unit)) + "\n";
    }
    put_levels();
    text_ = text;
    rig_.store = &store_;
    rig_.wall_clock = &wall_clock_;
    start(text + "[state]\nfolder = \"/state\"\ninterval = \"1min\"\n");
  }
  static int x_of(int unit) { return unit % 4 * 100 + unit * 37 % 23; }
  static int y_of(int unit) { return unit / 4 * 100 + unit * 53 % 29; }
  // A slope, and a few millimetres of noise.
  void put_levels() {
    for (int unit = first; unit <= last; ++unit) {
      if (unit == silent_) continue;
      random_ = random_ * 1664525u + 1013904223u;
      const int noise = static_cast<int>(random_ >> 29) - 3;
      const int offset = unit == drifting_ ? offset_ : 0;
      put_tank(static_cast<std::uint8_t>(unit),
               static_cast<std::int16_t>(x_of(unit) + 2 * y_of(unit) + noise + offset));
    }
  }
  void pass_minutes(int count) {
    for (int i = 0; i < count; ++i) {
      put_levels();
      rig_.run(1min);
    }
  }
  const PublishedReading& of(int unit) const {
    return *reading(1000 + static_cast<std::uint32_t>(unit), "level");
  }

  // Like start(), with the state of the gateway before; that one ends first.
  void start_again(port::Duration passed, const std::string& text) {
    rig_.gateway->finish(rig_.clock.now());
    start_again_from_store(passed, text);
  }
  void start_again_from_store(port::Duration passed, const std::string& text) {
    rig_.gateway.reset();
    std::vector<std::string> mistakes;
    Settings settings = read_configuration(folder_.write("site.toml", text), nullptr, mistakes);
    ASSERT_TRUE(mistakes.empty()) << mistakes.front();
    settings.files = rig_.settings.files;
    settings.state = rig_.settings.state;
    rig_.settings = settings;
    rig_.polled.clear();
    rig_.log.lines.clear();
    bus_ = {};
    put_levels();
    wall_clock_.pass(passed);
    rig_.start_with({&bus_});
    rig_.gateway->restore(rig_.clock.now());
  }

  // Node 7 begins to read 30 cm more. Who has not learned yet says nothing of it.
  bool finds_drift() {
    drifting_ = 7;
    offset_ = 300;
    pass_minutes(10);
    return of(7).disagrees;
  }

  MemoryStore store_;
  SetWallClock wall_clock_;
  std::string text_;
  std::uint32_t random_ = 7;
  int drifting_ = 0;
  int offset_ = 0;
  int silent_ = 0;
};

TEST_F(WatchedSensors, AreExpectedToReadWhatTheNodesAroundSay) {
  pass_minutes(260);
  ASSERT_TRUE(of(7).expected_nano);
  const double expected = x_of(7) + 2 * y_of(7);
  EXPECT_NEAR(static_cast<double>(*of(7).expected_nano) / 1e6, expected, 20);
  EXPECT_FALSE(of(7).disagrees);
}

TEST_F(WatchedSensors, AreToldWhenOneDisagreesAndWhenItAgreesAgain) {
  pass_minutes(260);
  EXPECT_EQ(rig_.log.count("disagreed"), 0u);
  const std::uint32_t generation = rig_.gateway->generation();
  drifting_ = 7;
  offset_ = 300;
  pass_minutes(10);
  EXPECT_TRUE(of(7).disagrees);
  EXPECT_FALSE(of(6).disagrees);
  EXPECT_EQ(rig_.log.count("node 1007: its level of "), 1u);
  EXPECT_EQ(rig_.log.count("by which it would be 0."), 1u);
  offset_ = 0;
  pass_minutes(30);
  EXPECT_FALSE(of(7).disagrees);
  EXPECT_EQ(rig_.log.count("node 1007: its level agrees with the nodes around it again"), 1u);
  EXPECT_EQ(rig_.gateway->generation(), generation) << "an alarm is no change of the mesh";
}

// A device that is not asked again says nothing new.
TEST_F(WatchedSensors, OneThatIsSilentKeepsItsState) {
  pass_minutes(260);
  drifting_ = 7;
  offset_ = 300;
  pass_minutes(10);
  silent_ = 7;
  bus_.silence(7);
  pass_minutes(20);
  EXPECT_TRUE(of(7).disagrees);
  EXPECT_TRUE(of(7).is_stale);
}

TEST_F(WatchedSensors, WhatWasLearnedOutlivesARestart) {
  pass_minutes(260);
  start_again(1h, text_);
  EXPECT_TRUE(finds_drift());
  EXPECT_EQ(rig_.log.count("node 1007: its level of "), 1u);
}

TEST_F(WatchedSensors, AfterAPowerFailureAtMostTenMinutesAreLost) {
  pass_minutes(262);
  const std::size_t saves = store_.saves;
  pass_minutes(60);
  EXPECT_LE(store_.saves, saves + 6) << "not each sample is saved";
  EXPECT_GE(store_.saves, saves + 5);
  const auto saved = store_.last;
  pass_minutes(3);
  store_.last = saved;
  start_again_from_store(0s, text_);
  EXPECT_TRUE(finds_drift());
}

TEST_F(WatchedSensors, AnAlarmOutlivesARestart) {
  pass_minutes(260);
  ASSERT_TRUE(finds_drift());
  start_again(1min, text_);
  pass_minutes(2);
  EXPECT_TRUE(of(7).disagrees);
  EXPECT_EQ(rig_.log.count("disagreed"), 0u) << "it was told before";
  offset_ = 0;
  pass_minutes(30);
  EXPECT_FALSE(of(7).disagrees);
  EXPECT_EQ(rig_.log.count("node 1007: its level agrees with the nodes around it again"), 1u);
}

TEST_F(WatchedSensors, WhatHasNotBeenReadAgainIsSavedAgain) {
  pass_minutes(260);
  for (int unit = first; unit <= last; ++unit) bus_.silence(static_cast<std::uint8_t>(unit));
  start_again(10min, text_);
  for (int unit = first; unit <= last; ++unit) bus_.silence(static_cast<std::uint8_t>(unit));
  rig_.run(30min);
  start_again(10min, text_);
  EXPECT_TRUE(finds_drift());
}

TEST_F(WatchedSensors, WhatIsTooOldIsForgotten) {
  pass_minutes(260);
  start_again(24h * 7, text_);
  EXPECT_FALSE(finds_drift());
}

TEST_F(WatchedSensors, AClockThatWasSetBackMakesNothingOld) {
  pass_minutes(260);
  wall_clock_.set(3);
  start_again(0s, text_);
  EXPECT_TRUE(finds_drift());
}

TEST_F(WatchedSensors, AnotherProfileIsLearnedAnew) {
  pass_minutes(260);
  std::string other = text_;
  start_again(1h, other.replace(other.find("i16\", scale"), 3, "i16"));
  ASSERT_TRUE(finds_drift()) << "the same profile, in other words";
  offset_ = 0;
  pass_minutes(30);
  other.replace(other.find("\"0.001\""), 7, "\"0.002\"");
  start_again(1h, other);
  EXPECT_FALSE(finds_drift());
}

TEST_F(WatchedSensors, ANodeThatStandsElsewhereIsLearnedAnew) {
  pass_minutes(260);
  std::string other = text_;
  const std::string x = "unit = 7\nx = " + std::to_string(x_of(7));
  start_again(
      1h, other.replace(other.find(x), x.size(), "unit = 7\nx = " + std::to_string(x_of(7) - 40)));
  drifting_ = 10;
  offset_ = 300;
  pass_minutes(10);
  EXPECT_TRUE(of(10).disagrees) << "the others know what they knew";
  offset_ = 0;
  pass_minutes(30);
  EXPECT_FALSE(finds_drift());
}

// Its checksum is that of whoever wrote it.
TEST_F(WatchedSensors, AStateThatMakesNoSenseIsRefusedWhole) {
  pass_minutes(260);
  rig_.gateway->finish(rig_.clock.now());
  const std::vector<std::byte> good = store_.last;
  // The references of the last sensor: no number.
  for (std::size_t i = 0; i < 8; ++i) store_.last[good.size() - 60 + i] = std::byte{0xff};
  store_.previous = good;
  start_again_from_store(1h, text_);
  EXPECT_EQ(rig_.log.count("the last copy is not used, what it says of a sensor is no number"), 1u);
  EXPECT_EQ(rig_.log.count("takes the copy before the last"), 1u);
  EXPECT_TRUE(finds_drift());
}

}  // namespace
}  // namespace etcm::firmware
