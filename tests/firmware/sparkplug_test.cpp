// The gateway as an edge node of Sparkplug: what it tells whom, and when.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "sparkplug_rig.h"

namespace etcm::firmware::sparkplug {
namespace {

using namespace std::chrono_literals;

TEST(SparkplugEdge, IsBornWithItsNodesWhenItConnects) {
  Rig rig{{feature(1001, 1003)}};
  rig.put_square();
  rig.run(1s);
  Edge edge(rig);
  edge.run(1s);
  EXPECT_TRUE(edge.broker.sent.empty());
  EXPECT_EQ(edge.broker.subscribed, Topics{"spBv1.0/plant/NCMD/north"});
  edge.connect();
  EXPECT_EQ(edge.broker.will.topic, "spBv1.0/plant/NDEATH/north");
  EXPECT_FALSE(edge.broker.will.retained);
  const auto death = test::read_sparkplug(edge.broker.will.payload);
  EXPECT_FALSE(death.sequence);
  ASSERT_EQ(death.metrics.size(), 1u);
  EXPECT_EQ(death.value("bdSeq"), "0");
  edge.run(100ms);
  const auto sent = edge.take();
  ASSERT_EQ(sent.size(), 5u);
  std::set<std::uint64_t> aliases;
  for (std::size_t i = 0; i < sent.size(); ++i) {
    EXPECT_EQ(sent[i].second.sequence, i);
    std::uint64_t before = 0;
    for (const test::SparkplugMetric& metric : sent[i].second.metrics) {
      EXPECT_FALSE(metric.name.empty());
      if (metric.alias) {
        EXPECT_TRUE(aliases.insert(*metric.alias).second) << metric.name;
      }
      EXPECT_GE(metric.timestamp, before) << metric.name;
      before = metric.timestamp;
    }
  }
  EXPECT_EQ(sent[0].first, "NBIRTH");
  const auto& gateway = sent[0].second;
  EXPECT_EQ(gateway.value("bdSeq"), "0");
  EXPECT_EQ(gateway.value("Node Control/Rebirth"), "false");
  EXPECT_FALSE(gateway.find("Node Control/Rebirth")->alias);
  EXPECT_EQ(gateway.value("Mesh/Generation"), std::to_string(rig.gateway->generation()));
  EXPECT_EQ(gateway.value("Mesh/Hash").size(), 16u);
  EXPECT_EQ(gateway.value("Mesh/Nodes"), "4");
  EXPECT_EQ(gateway.value("Mesh/Features"), "1");
  EXPECT_EQ(gateway.value("Mesh/State"), "0");
  std::set<std::string> devices;
  for (std::size_t i = 1; i < sent.size(); ++i) {
    devices.insert(sent[i].first);
    if (sent[i].first != "DBIRTH/1003") continue;
    const auto& node = sent[i].second;
    EXPECT_EQ(node.value("Position/X"), "100");
    EXPECT_EQ(node.value("Position/Fix"), "true");
    EXPECT_EQ(node.value("Position/Stale"), "false");
    EXPECT_EQ(node.value("Mesh/In mesh"), "true");
    EXPECT_EQ(node.value("Mesh/Neighbours"), "3");
    EXPECT_EQ(node.value("Low battery"), "false");
    EXPECT_EQ(node.value("Position/Longitude"), "none") << "nobody said where on the earth it is";
    EXPECT_LE(node.find("Position/X")->timestamp, node.timestamp);
    EXPECT_GE(node.find("Position/X")->timestamp + 200, node.timestamp);
  }
  EXPECT_EQ(devices,
            (std::set<std::string>{"DBIRTH/1001", "DBIRTH/1002", "DBIRTH/1003", "DBIRTH/1004"}));
}

TEST(SparkplugEdge, TellsOnlyWhatHasChanged) {
  Rig rig;
  rig.put_square();
  rig.run(1s);
  Edge edge(rig);
  edge.connect();
  edge.run(50ms);
  std::map<std::uint64_t, std::string> names;
  for (const auto& [topic, payload] : edge.take()) {
    for (const auto& metric : payload.metrics) {
      if (metric.alias) names[*metric.alias] = topic + " " + metric.name;
    }
  }
  edge.run(3s);
  EXPECT_EQ(edge.take_topics(), Topics{});
  rig.put(2, 150, -7, node_status::fix_valid | node_status::low_battery);
  edge.run(1200ms);
  std::set<std::string> changed;
  std::uint64_t sequence = 5;
  for (const auto& [topic, payload] : edge.take()) {
    EXPECT_EQ(payload.sequence, sequence++);
    for (const auto& metric : payload.metrics) {
      EXPECT_EQ(metric.name, "");
      changed.insert(names.at(metric.alias.value()) + " = " + metric.value);
    }
  }
  EXPECT_TRUE(changed.contains("DBIRTH/1002 Position/X = 150"));
  EXPECT_TRUE(changed.contains("DBIRTH/1002 Position/Y = -7"));
  EXPECT_TRUE(changed.contains("DBIRTH/1002 Low battery = true"));
  EXPECT_TRUE(
      changed.contains("NBIRTH Mesh/Generation = " + std::to_string(rig.gateway->generation())));
  for (const std::string& line : changed) {
    EXPECT_TRUE(line.starts_with("DBIRTH/1002") || line.starts_with("NBIRTH") ||
                line.find("Neighbours") != std::string::npos)
        << line;
  }
}

TEST(SparkplugEdge, CountsItsMessagesUpTo255) {
  Rig rig;
  rig.put_square();
  rig.run(1s);
  Edge edge(rig, 20ms);
  edge.connect();
  std::uint64_t expected = 0;
  for (std::int32_t round = 0; round < 600; ++round) {
    rig.put(1, -round, -2 * round);
    edge.run(110ms);
    for (const auto& [topic, payload] : edge.take()) {
      ASSERT_EQ(payload.sequence, expected % 256);
      ++expected;
    }
  }
  EXPECT_GT(expected, 600u);
}

TEST(SparkplugEdge, ANodeThatIsSilentDiesAndIsBornAgain) {
  Rig rig;
  rig.put_square();
  rig.run(1s);
  Edge edge(rig, 100ms);
  edge.connect();
  edge.run(500ms);
  edge.take();
  rig.bus.silence(2);
  edge.run(1500ms);
  Topics topics = edge.take_topics();
  EXPECT_EQ(std::count(topics.begin(), topics.end(), "DDEATH/1002"), 1);
  edge.run(4s);
  EXPECT_EQ(rig.gateway->snapshot().missing_count, 1u);
  topics = edge.take_topics();
  EXPECT_EQ(std::count(topics.begin(), topics.end(), "DDEATH/1002"), 0);
  EXPECT_EQ(std::count(topics.begin(), topics.end(), "NDATA"), 1);
  rig.put(2, 100, 0);
  edge.run(1s);
  topics = edge.take_topics();
  EXPECT_EQ(std::count(topics.begin(), topics.end(), "DBIRTH/1002"), 1);
}

TEST(SparkplugEdge, ANodeWithoutAFixLivesAndItsPositionIsStale) {
  Rig rig;
  rig.put_square();
  rig.run(1s);
  Edge edge(rig, 100ms);
  edge.connect();
  edge.run(500ms);
  edge.take();
  rig.put(2, 0, 0, 0);
  edge.run(2s);
  std::map<std::string, std::string> qualities;
  for (const auto& [topic, payload] : edge.take()) {
    EXPECT_FALSE(topic.starts_with("DDEATH")) << topic;
    for (const auto& metric : payload.metrics) {
      if (metric.properties.contains("Quality")) {
        qualities[topic + metric.value] = metric.properties.at("Quality");
      }
    }
  }
  EXPECT_EQ(qualities,
            (std::map<std::string, std::string>{{"DDATA/1002100", "500"}, {"DDATA/10020", "500"}}));
  rig.put(2, 100, 0);
  edge.run(500ms);
  for (const auto& [topic, payload] : edge.take()) {
    for (const auto& metric : payload.metrics) {
      if (metric.datatype == 3 && metric.properties.contains("Quality")) {
        EXPECT_EQ(metric.properties.at("Quality"), "192");
      }
    }
  }
}

TEST(SparkplugEdge, NodesOfOtherGatewaysAreNotItsDevices) {
  NodeRecord node;
  EXPECT_FALSE(is_alive(node));
  node.serial = Serial{1001};
  EXPECT_TRUE(is_alive(node));
  node.owner = MemberIndex{0};
  EXPECT_FALSE(is_alive(node));
}

TEST(SparkplugEdge, AnswersARebirthOnceASecond) {
  Rig rig;
  rig.put_square();
  rig.run(1s);
  Edge edge(rig);
  edge.connect();
  edge.run(2s);
  edge.take();
  edge.ask_for_rebirth();
  edge.run(50ms);
  auto sent = edge.take();
  ASSERT_EQ(sent.size(), 5u);
  EXPECT_EQ(sent[0].first, "NBIRTH");
  EXPECT_EQ(sent[0].second.sequence, 0u);
  EXPECT_EQ(sent[0].second.value("bdSeq"), "0") << "of the same connection";
  for (int i = 0; i < 100; ++i) {
    edge.ask_for_rebirth();
    edge.run(20ms);
  }
  Topics topics = edge.take_topics();
  EXPECT_EQ(std::count(topics.begin(), topics.end(), "NBIRTH"), 2);
}

TEST(SparkplugEdge, NothingElseThatArrivesDoesAnything) {
  Rig rig;
  rig.put_square();
  rig.run(1s);
  Edge edge(rig);
  edge.connect();
  edge.run(2s);
  edge.take();
  const port::Instant now = rig.clock.now();
  edge.broker.bring("spBv1.0/plant/NCMD/north", rebirth_command(false), now);
  edge.broker.bring("spBv1.0/plant/NCMD/north", rebirth_command(true, "Mesh/Nodes"), now);
  edge.broker.bring("spBv1.0/plant/NCMD/north", "nonsense", now);
  edge.broker.bring("spBv1.0/plant/NCMD/north", rebirth_command(), now, true);
  edge.broker.bring("spBv1.0/plant/NCMD/south", rebirth_command(), now);
  edge.broker.bring("spBv1.0/plant/DCMD/north/1001", rebirth_command(), now);
  std::string long_command;
  while (long_command.size() < 5000) long_command += rebirth_command();
  edge.broker.bring("spBv1.0/plant/NCMD/north", long_command, now);
  edge.run(3s);
  EXPECT_EQ(edge.take_topics(), Topics{});
}

TEST(SparkplugEdge, EachConnectionHasANumberOfItsOwn) {
  Rig rig;
  rig.put_square();
  rig.run(1s);
  Edge edge(rig);
  for (unsigned connection = 0; connection < 260; ++connection) {
    edge.connect();
    const std::string number = std::to_string(connection % 256);
    EXPECT_EQ(test::read_sparkplug(edge.broker.will.payload).value("bdSeq"), number);
    edge.run(30ms);
    const auto sent = edge.take();
    ASSERT_EQ(sent.size(), 5u);
    EXPECT_EQ(sent[0].second.value("bdSeq"), number);
    EXPECT_EQ(sent[0].second.sequence, 0u);
    edge.broker.end(rig.clock.now());
    edge.run(20ms);
    EXPECT_EQ(edge.take_topics(), Topics{});
  }
}

TEST(SparkplugEdge, ABrokerWithLittleRoomGetsAllInOrder) {
  Rig rig;
  rig.put_square();
  rig.run(1s);
  Edge edge(rig);
  edge.broker.room = 0;
  edge.connect();
  for (std::uint64_t sequence = 0; sequence < 5; ++sequence) {
    edge.run(100ms);
    EXPECT_EQ(edge.take_topics(), Topics{});
    edge.broker.room = 1;
    edge.run(100ms);
    const auto sent = edge.take();
    ASSERT_EQ(sent.size(), 1u);
    EXPECT_EQ(sent[0].second.sequence, sequence);
    EXPECT_EQ(sent[0].first.starts_with("NBIRTH"), sequence == 0);
  }
}

// Metres about a place where a degree is a hundred kilometres.
class RoundEarth final : public port::Projection {
 public:
  std::optional<port::PlanePoint> to_plane(port::EarthPoint) const override { return {}; }
  std::optional<port::EarthPoint> to_earth(port::PlanePoint point) const override {
    ++asked;
    return port::EarthPoint{.longitude = point.x / 100'000, .latitude = point.y / 100'000};
  }
  bool counts_in_degrees() const override { return false; }
  double metres() const override { return 1; }
  mutable int asked = 0;
};

TEST(SparkplugEdge, TellsDegreesWhereThereAreSomeAndAsksForThemOnce) {
  Rig rig;
  const auto earth = std::make_shared<RoundEarth>();
  rig.settings.site.projection = earth;
  rig.put_square();
  rig.run(1s);
  Edge edge(rig, 100ms);
  edge.connect();
  // The files of the gateway ask as well.
  const auto asked_within = [&](port::Duration duration) {
    int asked = 0;
    for (port::Duration passed{}; passed < duration; passed += 10ms) {
      rig.run(10ms);
      const int before = earth->asked;
      edge.node->step(rig.clock.now());
      asked += earth->asked - before;
    }
    return asked;
  };
  EXPECT_EQ(asked_within(2s), 4);
  for (const auto& [topic, payload] : edge.take()) {
    if (topic != "DBIRTH/1002") continue;
    EXPECT_EQ(payload.value("Position/Longitude"), "0.001000");
    EXPECT_EQ(payload.value("Position/Latitude"), "0.000000");
  }
  rig.put(2, 300, 0);
  EXPECT_EQ(asked_within(500ms), 1);
}

}  // namespace
}  // namespace etcm::firmware::sparkplug
