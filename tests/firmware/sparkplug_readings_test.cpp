// What nodes measure, told to Sparkplug hosts.
#include <gtest/gtest.h>

#include <map>

#include "measuring.h"
#include "sparkplug_rig.h"
#include "support/allocation_watch.h"

namespace etcm::firmware::sparkplug {
namespace {

using namespace std::chrono_literals;

class SparkplugReadings : public Measuring {};

TEST_F(SparkplugReadings, HaveUnitsAndQuality) {
  start();
  put_tank(2, 1500);
  put_well(5, 77, 8.5f, 1'250'000'000);
  rig_.run(1s);
  Edge edge(rig_, 100ms);
  edge.connect();
  edge.run(100ms);
  std::map<std::string, test::SparkplugPayload> births;
  for (auto& [topic, payload] : edge.take()) births[topic] = payload;
  const auto& tank = births.at("DBIRTH/1002");
  EXPECT_EQ(tank.value("Readings/level"), "1.500000");
  EXPECT_EQ(tank.find("Readings/level")->properties.at("engUnit"), "m");
  EXPECT_FALSE(tank.find("Readings/level")->properties.contains("Quality"));
  EXPECT_EQ(births.at("DBIRTH/77").value("Readings/temperature"), "8.500000");
  EXPECT_EQ(births.at("DBIRTH/77").value("Readings/level"), "1.250000");
  const std::uint64_t level = tank.find("Readings/level")->alias.value();
  put_tank(2, 32767);
  edge.run(300ms);
  auto sent = edge.take();
  ASSERT_EQ(sent.size(), 1u);
  EXPECT_EQ(sent[0].first, "DDATA/1002");
  ASSERT_EQ(sent[0].second.metrics.size(), 1u);
  EXPECT_EQ(sent[0].second.metrics[0].alias, level);
  EXPECT_EQ(sent[0].second.metrics[0].value, "null");
}

TEST_F(SparkplugReadings, OfDevicesThatAReloadAddsAreBornWithThem) {
  start();
  put_tank(2, 1500);
  rig_.run(1s);
  Edge edge(rig_, 100ms);
  edge.connect();
  edge.run(500ms);
  edge.take();
  Profile large = rig_.settings.device_profiles.at(0);
  large.name = "large";
  for (int i = 0; i < 20; ++i) {
    large.readings.push_back(large.readings.at(0));
    large.readings.back().name = "level " + std::to_string(i);
  }
  rig_.settings.device_profiles.push_back(large);
  BusSettings gate = rig_.settings.buses.at(0);
  gate.name = "gate";
  gate.units.clear();
  gate.devices = {{.units = {{.first = 9, .last = 9}}, .profile = "large", .timeout = 50ms}};
  gate.units = gate.devices.at(0).units;
  rig_.settings.buses.push_back(gate);
  DeviceBus other;
  other.put(9, 3, {700});
  rig_.update_settings({&other});
  edge.node->update_settings(rig_.settings);
  edge.run(2s);
  std::map<std::string, test::SparkplugPayload> births;
  for (auto& [topic, payload] : edge.take()) births[topic] = payload;
  EXPECT_TRUE(births.contains("NBIRTH"));
  EXPECT_TRUE(births.contains("DBIRTH/1002"));
  EXPECT_EQ(births.at("DBIRTH/2009").value("Readings/level 19"), "0.700000");
}

// Takes all and keeps nothing.
class SilentBroker final : public port::MessageBroker {
 public:
  bool is_connected() const override { return true; }
  std::string_view why_down() const override { return {}; }
  const port::BrokerCounters& counters() const override { return counters_; }
  void set_listener(port::BrokerListener* who) override { listener = who; }
  void set_last_will(const port::BrokerMessage&) override {}
  void subscribe(std::span<const std::string>) override {}
  bool publish(const port::BrokerMessage& message, std::uint32_t) override {
    bytes += message.payload.size();
    ++messages;
    return true;
  }
  void step(port::Instant) override {}
  port::Instant next_deadline() const override { return port::never; }
  port::BrokerListener* listener = nullptr;
  std::size_t bytes = 0, messages = 0;

 private:
  port::BrokerCounters counters_;
};

TEST_F(SparkplugReadings, TakeNoMemoryWhileTheyChange) {
  start();
  put_tank(2, 1500);
  put_well(5, 77, 8.5f, 1'250'000'000);
  rig_.run(1s);
  SilentBroker broker;
  FollowingWallClock wall(rig_.clock);
  EdgeNode node({.group = "plant", .edge_node = "north"}, rig_.settings, 100ms,
                {.nodes = rig_.gateway->nodes(),
                 .mesh = rig_.gateway->snapshot(),
                 .readings = rig_.gateway->readings()},
                broker, wall);
  std::size_t allocations = 0;
  for (std::int16_t round = 0; round < 100; ++round) {
    put_tank(2, round);
    rig_.run(100ms);
    const test::AllocationWatch watch;
    if (round == 0) broker.listener->on_connected(rig_.clock.now());
    if (round == 50) {
      broker.listener->on_message({.topic = "spBv1.0/plant/NCMD/north", .payload = "\x12\x01\x0a"},
                                  rig_.clock.now());
    }
    node.step(rig_.clock.now());
    allocations += watch.allocations();
  }
  EXPECT_EQ(allocations, 0u);
  EXPECT_GT(broker.messages, 90u);
}

}  // namespace
}  // namespace etcm::firmware::sparkplug
