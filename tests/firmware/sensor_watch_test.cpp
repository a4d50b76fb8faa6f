// Sensors that a gateway polls, and one that drifts away from the others.
#include "firmware/readings/sensor_watch.h"

#include <gtest/gtest.h>

#include <string>

#include "measuring.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

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
    start(text);
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

}  // namespace
}  // namespace etcm::firmware
