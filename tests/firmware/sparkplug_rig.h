// An edge node of Sparkplug on a gateway in the test's hand, and what it has sent.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "etcm/port/wall_clock.h"
#include "fakes.h"
#include "firmware/sparkplug/edge_node.h"
#include "protobuf_reader.h"
#include "rebirth_command.h"
#include "recording_broker.h"

namespace etcm::firmware::sparkplug {

using test::rebirth_command;

// A rig with an edge node, which a broker is there for.
struct Edge {
  explicit Edge(Rig& of, port::Duration pause = std::chrono::seconds(1)) : rig(of), wall(of.clock) {
    node = std::make_unique<EdgeNode>(EdgeNodeNames{.group = "plant", .edge_node = "north"},
                                      rig.settings, pause,
                                      Sources{.nodes = rig.gateway->nodes(),
                                              .mesh = rig.gateway->snapshot(),
                                              .readings = rig.gateway->readings()},
                                      broker, wall);
  }
  void run(port::Duration duration) {
    for (port::Duration passed{}; passed < duration; passed += std::chrono::milliseconds(10)) {
      rig.run(std::chrono::milliseconds(10));
      node->step(rig.clock.now());
    }
  }
  void connect() { broker.connect(rig.clock.now()); }
  // What was sent since the last call, by "TYPE" or "TYPE/device".
  std::vector<std::pair<std::string, test::SparkplugPayload>> take() {
    std::vector<std::pair<std::string, test::SparkplugPayload>> all;
    for (const auto& message : broker.sent) {
      EXPECT_FALSE(message.retained);
      EXPECT_TRUE(message.at_most_once);
      std::string topic = message.topic;
      EXPECT_TRUE(topic.starts_with("spBv1.0/plant/")) << topic;
      topic = topic.substr(sizeof "spBv1.0/plant/" - 1);
      const std::size_t at = topic.find("/north");
      EXPECT_NE(at, std::string::npos) << topic;
      all.emplace_back(topic.erase(at, sizeof "/north" - 1), test::read_sparkplug(message.payload));
    }
    broker.sent.clear();
    return all;
  }
  // The names of the same.
  std::vector<std::string> take_topics() {
    std::vector<std::string> topics;
    for (const auto& [topic, payload] : take()) topics.push_back(topic);
    return topics;
  }
  void ask_for_rebirth() {
    broker.bring("spBv1.0/plant/NCMD/north", rebirth_command(), rig.clock.now());
  }

  Rig& rig;
  FollowingWallClock wall;
  RecordingBroker broker;
  std::unique_ptr<EdgeNode> node;
};

using Topics = std::vector<std::string>;

}  // namespace etcm::firmware::sparkplug
