// What Home Assistant is told of the nodes, and when.
#include "firmware/home_assistant/announcer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "measuring.h"
#include "recording_broker.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

std::string topic_of(std::uint32_t serial) {
  return "ha/device/etcm_old_yard_" + std::to_string(serial) + "/config";
}

class Announcing : public Measuring {
 protected:
  void SetUp() override {
    start();
    put_tank(2, 1500);
    put_well(5, 77, 8.5f, 1'250'000'000);
    rig_.run(1s);
    rig_.settings.mqtt =
        MqttSettings{.broker = {}, .site = "old.yard", .name = "north", .home_assistant = "ha"};
    announcer_ = std::make_unique<Announcer>(rig_.settings, "1.2", rig_.gateway->nodes(),
                                             rig_.gateway->readings(), broker_);
  }
  void run(port::Duration duration) {
    for (port::Duration passed{}; passed < duration; passed += 10ms) {
      rig_.run(10ms);
      announcer_->step(rig_.clock.now(), fleet_);
    }
  }
  // The topics of what was sent since the last call; those that are taken back with a '-'.
  std::vector<std::string> take() {
    std::vector<std::string> topics;
    for (const auto& message : broker_.sent) {
      EXPECT_TRUE(message.retained);
      EXPECT_FALSE(message.at_most_once);
      topics.push_back((message.payload.empty() ? "-" : "") + message.topic);
    }
    broker_.sent.clear();
    std::sort(topics.begin(), topics.end());
    return topics;
  }

  RecordingBroker broker_;
  std::unique_ptr<Announcer> announcer_;
  FleetStanding fleet_{.has_told_all = true};
};

using Topics = std::vector<std::string>;

TEST_F(Announcing, EachNodeOnceAndAgainInEachSession) {
  run(2s);
  EXPECT_EQ(take(), Topics{});
  broker_.connect(rig_.clock.now());
  run(2s);
  EXPECT_EQ(take(), (Topics{topic_of(1002), topic_of(77)}));
  put_tank(2, 1700);
  run(3s);
  EXPECT_EQ(take(), Topics{}) << "a value is no news here";
  broker_.end(rig_.clock.now());
  broker_.connect(rig_.clock.now());
  run(2s);
  EXPECT_EQ(take(), (Topics{topic_of(1002), topic_of(77)}));
}

// A broker may hang up on who says what it does not let it say: the fleet knew nothing of a gateway
// whose nodes Home Assistant was not to know.
TEST_F(Announcing, NothingGoesBeforeWhatTheFleetIsTold) {
  fleet_.has_told_all = false;
  broker_.connect(rig_.clock.now());
  run(5s);
  EXPECT_EQ(take(), Topics{});
  EXPECT_GT(announcer_->next_deadline(), rig_.clock.now()) << "it spins";
  fleet_.has_told_all = true;
  run(2s);
  EXPECT_EQ(take(), (Topics{topic_of(1002), topic_of(77)}));
}

TEST_F(Announcing, WhatIsRefusedIsTriedAgainInAnHourOrAfterAReload) {
  broker_.connect(rig_.clock.now());
  run(2s);
  EXPECT_EQ(take().size(), 2u);
  fleet_.other_refused_count = 1;
  broker_.end(rig_.clock.now());
  run(100ms);
  broker_.connect(rig_.clock.now());
  rig_.clock.pass(59min);
  run(1s);
  EXPECT_EQ(take(), Topics{});
  rig_.clock.pass(1min);
  run(2s);
  EXPECT_EQ(take().size(), 2u);
  ++fleet_.other_refused_count;
  run(2s);
  broker_.end(rig_.clock.now());
  broker_.connect(rig_.clock.now());
  run(2s);
  EXPECT_EQ(take(), Topics{});
  announcer_->update_settings(rig_.settings);
  run(2s);
  EXPECT_EQ(take().size(), 2u);
}

TEST_F(Announcing, ANodeGoesByItsName) {
  rig_.settings.node_names = {{.serial = Serial{77}, .name = "old \"well\""}};
  rig_.update_settings();
  broker_.connect(rig_.clock.now());
  run(2s);
  const auto sent = std::find_if(broker_.sent.begin(), broker_.sent.end(),
                                 [](const auto& message) { return message.topic == topic_of(77); });
  ASSERT_NE(sent, broker_.sent.end());
  EXPECT_NE(sent->payload.find(R"("name":"old \"well\"","serial_number":"77")"), std::string::npos)
      << sent->payload;
  take();
  rig_.settings.node_names.clear();
  rig_.update_settings();
  run(2s);
  EXPECT_EQ(take(), Topics{topic_of(77)}) << "it has another one";
}

TEST_F(Announcing, AllIsSaidAgainInAnHour) {
  broker_.connect(rig_.clock.now());
  run(2s);
  EXPECT_EQ(take().size(), 2u);
  rig_.clock.pass(59min);
  run(2s);
  EXPECT_EQ(take(), Topics{});
  rig_.clock.pass(1min);
  run(2s);
  EXPECT_EQ(take(), (Topics{topic_of(1002), topic_of(77)}));
}

TEST_F(Announcing, ANodeThatIsKnownNoMoreIsTakenBack) {
  broker_.connect(rig_.clock.now());
  run(2s);
  take();
  bus_.silence(5);
  run(5s);
  EXPECT_EQ(rig_.gateway->snapshot().missing_count, 1u);
  EXPECT_EQ(take(), Topics{}) << "it is missing, so it is known";
  EXPECT_TRUE(rig_.gateway->dismiss(Serial{77}));
  run(2s);
  EXPECT_EQ(take(), Topics{"-" + topic_of(77)});
}

TEST_F(Announcing, ABrokerWithLittleRoomGetsAll) {
  broker_.room = 0;
  broker_.connect(rig_.clock.now());
  run(500ms);
  EXPECT_EQ(take(), Topics{});
  broker_.room = 1;
  run(500ms);
  EXPECT_EQ(take().size(), 1u);
  broker_.room = 1;
  run(500ms);
  EXPECT_EQ(take().size(), 1u);
}

TEST(Discovery, TheMessageHasWhatTheNodeHas) {
  const AnnouncedReading readings[] = {{.name = "it's \\ a level", .unit = "m"}, {.name = "b"}};
  const std::string text = announcement({.site = "yard",
                                         .gateway = "north",
                                         .serial = Serial{1001},
                                         .has_degrees = true,
                                         .readings = readings},
                                        "1.2");
  for (const char* part :
       {R"("device":{"identifiers":["etcm_yard_1001"],"name":"Node 1001","serial_number":"1001"})",
        R"("origin":{"name":"etcm-gateway","sw_version":"1.2"})",
        R"("availability":[{"topic":"etcm/v1/yard/north/header")", R"("platform":"device_tracker")",
        R"("unit_of_measurement":"m")", R"(selectattr('name', 'eq', 'it\\'s \\\\ a level'))",
        R"("state_topic":"etcm/v1/yard/north/node/000003e9")"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << " in " << text;
  }
  EXPECT_EQ(announcement({.site = "yard", .gateway = "north", .serial = Serial{1}}, "1.2")
                .find("device_tracker"),
            std::string::npos);
}

// Though it goes on answering.
TEST(AnnouncingNodes, OneThatHasLeftIsTakenBack) {
  Rig rig;
  rig.put_square();
  rig.run(1s);
  rig.settings.mqtt =
      MqttSettings{.broker = {}, .site = "old.yard", .name = "north", .home_assistant = "ha"};
  RecordingBroker broker;
  Announcer announcer(rig.settings, "1.2", rig.gateway->nodes(), rig.gateway->readings(), broker);
  const auto run = [&] {
    for (int i = 0; i < 300; ++i) {
      rig.run(10ms);
      announcer.step(rig.clock.now(), {.has_told_all = true});
    }
  };
  broker.connect(rig.clock.now());
  run();
  EXPECT_EQ(broker.sent.size(), 4u);
  rig.put(3, 100, 100, node_status::fix_valid | node_status::leaving);
  run();
  ASSERT_EQ(broker.sent.size(), 5u);
  EXPECT_EQ(broker.sent.back().topic, topic_of(1003));
  EXPECT_EQ(broker.sent.back().payload, "");
  rig.put(3, 100, 100);
  run();
  ASSERT_EQ(broker.sent.size(), 6u);
  EXPECT_NE(broker.sent.back().payload, "") << "it is back";
}

}  // namespace
}  // namespace etcm::firmware
