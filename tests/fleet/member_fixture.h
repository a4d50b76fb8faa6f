// One member whose broker and whose peers are in the test's hand.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "firmware/fleet/fleet_hash.h"
#include "firmware/fleet/fleet_member.h"
#include "firmware/fleet/fleet_topics.h"
#include "firmware/fleet/header_codec.h"
#include "firmware/fleet/record_codec.h"
#include "recording_broker.h"

namespace etcm::test {

using namespace std::chrono_literals;
using namespace etcm::firmware;

inline FleetSettings member_settings(const std::string& name = "a", std::uint64_t instance = 10) {
  FleetSettings settings;
  settings.site = "yard";
  settings.gateway = name;
  settings.instance = instance;
  settings.period = 20s;
  settings.silent_after = 60s;
  settings.leave_after = 300s;
  settings.report_min = 5s;
  settings.report_max = 100s;
  settings.settle = 2s;
  settings.nodes_max = 20;
  settings.members_max = 4;
  return settings;
}

inline FleetNode node_at(std::uint32_t serial, std::int32_t x, std::int32_t y = 0) {
  return {.serial = Serial{serial}, .position = Position{.x = x, .y = y}, .status = 1};
}

inline FleetRecord record_of(std::uint32_t serial, std::int32_t x, const std::string& owner,
                             std::uint32_t incarnation, std::uint32_t sequence) {
  return {.node = node_at(serial, x),
          .owner = owner,
          .incarnation = incarnation,
          .sequence = sequence,
          .is_heard = true};
}

class FleetMemberTest : public ::testing::Test {
 protected:
  explicit FleetMemberTest(FleetSettings settings = member_settings()) : settings_(settings) {
    start();
  }

  void start() {
    member.reset();
    broker = RecordingBroker{};
    member = std::make_unique<FleetMember>(settings_, broker, gateway, gateway, now);
  }
  void pass(port::Duration time, port::Duration turn = 500ms) {
    for (const port::Instant end = now + time; now < end;) {
      now += turn;
      member->step(now);
      broker.deliver_all(now);
    }
  }
  void connect() { member->on_connected(now); }
  void settle() {
    connect();
    pass(settings_.settle + 500ms);
  }
  void disconnect() { member->on_disconnected("the cable", now); }
  void hear(std::uint32_t serial, std::int32_t x) {
    EXPECT_TRUE(member->hear(node_at(serial, x), now));
  }

  // --- what others say
  void say(const std::string& topic, const std::string& payload, bool is_kept = false) {
    member->on_message({.topic = "etcm/v1/yard/" + topic, .payload = payload, .retained = is_kept},
                       now);
  }
  void say_header(const std::string& name, std::uint32_t beat, bool is_online = true,
                  std::uint64_t instance = 77) {
    FleetHeader header{.run = {.instance = instance, .epoch = 1}, .beat = beat};
    header.is_online = is_online;
    header.merged_count = member->status().node_count;
    header.merged_hash = member->status().merged_hash;
    say(name + "/header", encode_header(header));
  }
  void say_set(const std::string& name, const std::vector<FleetRecord>& records) {
    FleetSetSummary set{.run = {.instance = 77, .epoch = 1},
                        .count = static_cast<std::uint32_t>(records.size())};
    for (const FleetRecord& record : records) set.hash += record_hash(record);
    say(name + "/set", encode_set(set));
  }
  void say_node(const std::string& name, const FleetRecord& record) {
    say(name + "/" + topic_tail(TopicKind::node, record.node.serial), encode_record(record));
  }
  // A peer that is there and has these records.
  void meet(const std::string& name, const std::vector<FleetRecord>& records,
            std::uint32_t beat = 1) {
    say_header(name, beat);
    for (const FleetRecord& record : records) say_node(name, record);
    say_set(name, records);
  }
  // The broker comes back with what this member had published there.
  void echo_kept() {
    const std::vector<RecordingBroker::Published> published = broker.published;
    for (const auto& each : published) {
      if (!each.is_retained) continue;
      member->on_message(
          {.topic = each.topic, .payload = broker.last(each.topic), .retained = true}, now);
    }
  }

  FleetRecord published(std::uint32_t serial) {
    std::string wrong;
    const std::string tail = "a/" + topic_tail(TopicKind::node, Serial{serial});
    const auto record = decode_record(broker.last(tail), Serial{serial}, wrong);
    EXPECT_TRUE(record) << broker.last(tail) << ": " << wrong;
    return record.value_or(FleetRecord{});
  }
  std::string node_topic(std::uint32_t serial) {
    return "a/" + topic_tail(TopicKind::node, Serial{serial});
  }
  std::size_t count_lines(const std::string& part) const {
    return static_cast<std::size_t>(std::count_if(
        gateway.lines.begin(), gateway.lines.end(),
        [&](const std::string& line) { return line.find(part) != std::string::npos; }));
  }

  FleetSettings settings_;
  port::Instant now{1h};
  RecordingGateway gateway;
  RecordingBroker broker;
  std::unique_ptr<FleetMember> member;
};

}  // namespace etcm::test
