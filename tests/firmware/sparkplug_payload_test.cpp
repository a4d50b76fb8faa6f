// What payloads of Sparkplug have, and which commands count.
#include <gtest/gtest.h>

#include <limits>

#include "sparkplug_rig.h"

namespace etcm::firmware::sparkplug {
namespace {

TEST(SparkplugPayload, HasWhatTheSpecificationSays) {
  std::vector<char> room(payload_bytes_max(3));
  PayloadWriter writer(room);
  writer.begin(wall_start_ms);
  writer.add_birth({.name = "level",
                    .unit = "m",
                    .alias = std::uint64_t{1} << 40,
                    .measured_ms = wall_start_ms - 5,
                    .value = {.kind = Kind::real, .is_null = true, .is_stale = true}});
  writer.add_birth({.name = "x", .alias = 7, .measured_ms = -5, .value = Value::whole(-40)});
  writer.add_change({.name = "hash", .alias = 8, .value = Value::hex(0x00ab)}, true);
  const auto payload = test::read_sparkplug(writer.finish(255));
  EXPECT_EQ(payload.timestamp, static_cast<std::uint64_t>(wall_start_ms));
  EXPECT_EQ(payload.sequence, 255u);
  ASSERT_EQ(payload.metrics.size(), 3u);
  const test::SparkplugMetric& level = payload.metrics[0];
  EXPECT_EQ(level.name, "level");
  EXPECT_EQ(level.alias, std::uint64_t{1} << 40);
  EXPECT_EQ(level.timestamp, static_cast<std::uint64_t>(wall_start_ms - 5));
  EXPECT_EQ(level.datatype, 10u);
  EXPECT_EQ(level.value, "null");
  EXPECT_EQ(level.properties.at("engUnit"), "m");
  EXPECT_EQ(level.properties.at("Quality"), "500");
  EXPECT_EQ(payload.metrics[1].value, "-40");
  EXPECT_EQ(payload.metrics[1].timestamp, 0u) << "a clock before 1970 was not set";
  EXPECT_EQ(payload.metrics[2].name, "") << "who has the birth knows it by its alias";
  EXPECT_EQ(payload.metrics[2].value, "00000000000000ab");
  EXPECT_EQ(payload.metrics[2].properties.at("Quality"), "192") << "fresh again";
}

TEST(SparkplugPayload, TheLongestTextsFitItsRoom) {
  std::vector<char> room(payload_bytes_max(70));
  PayloadWriter writer(room);
  writer.begin(std::numeric_limits<std::int64_t>::max());
  for (int i = 0; i < 70; ++i) {
    writer.add_birth({.name = std::string(200, 'n'),
                      .unit = std::string(200, 'u'),
                      .alias = ~std::uint64_t{0},
                      .measured_ms = std::numeric_limits<std::int64_t>::max(),
                      .value = {.kind = Kind::hex, .is_stale = true, .bits = ~std::uint64_t{0}}});
  }
  const auto payload = test::read_sparkplug(writer.finish(255));
  EXPECT_EQ(payload.metrics.at(69).name, std::string(metric_name_max, 'n'));
  EXPECT_EQ(payload.metrics.at(69).properties.at("engUnit"), std::string(metric_unit_max, 'u'));
}

TEST(SparkplugPayload, OnlyTheRightCommandAsksForBirths) {
  EXPECT_TRUE(asks_for_rebirth(rebirth_command()));
  EXPECT_FALSE(asks_for_rebirth(rebirth_command(false)));
  EXPECT_FALSE(asks_for_rebirth(rebirth_command(true, "Node Control/Reboot")));
  EXPECT_FALSE(asks_for_rebirth(""));
  // Behind a name that is longer than any of ours, and behind nonsense.
  EXPECT_TRUE(asks_for_rebirth(rebirth_command(true, std::string(60, 'x')) + rebirth_command()));
  EXPECT_TRUE(asks_for_rebirth(std::string("\x12\x03\xff\xff\xff") + rebirth_command()));
  const std::string whole = rebirth_command();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(asks_for_rebirth(whole.substr(0, size))) << size;
  }
  std::uint32_t chance = 1;
  for (int round = 0; round < 20'000; ++round) {
    std::string bytes = whole;
    for (int i = 0; i < 4; ++i) {
      chance = chance * 1664525 + 1013904223;
      bytes[(chance >> 8) % bytes.size()] = static_cast<char>(chance >> 24);
    }
    static_cast<void>(asks_for_rebirth(bytes));
  }
}

}  // namespace
}  // namespace etcm::firmware::sparkplug
