// What a member takes of memory for each node. The bounds are those of firmware/guide/capacity.md,
// a twentieth above what it is with 64 bits.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <memory>
#include <string>

#include "member_fixture.h"
#include "support/allocation_watch.h"

namespace etcm::test {
namespace {

constexpr std::uint32_t node_count = 987;
constexpr double own_bytes_max = 2300;
constexpr double foreign_bytes_max = 750;

// Remembers nothing.
class QuietGateway final : public FleetListener, public port::Log {
 public:
  void on_node(const FleetRecord&, bool, port::Instant) override {}
  void on_node_gone(Serial, LeftReason, port::Instant) override {}
  void on_peer(const PeerReport&, port::Instant) override {}
  void on_name_conflict(bool, bool, port::Instant) override {}
  std::string on_site(const SiteDocument&, port::Instant) override { return ""; }
  void write(port::Level, std::string_view) override {}
};

// As long as nodes with names and two readings on the earth are.
FleetNode full_node(std::uint32_t serial) {
  FleetNode node = node_at(serial, static_cast<std::int32_t>(7 * serial), 1234567);
  node.name = "pump house " + std::to_string(serial);
  node.longitude = "16.7264318";
  node.latitude = "63.4187204";
  node.readings = {{.name = "temperature", .unit = "Cel", .nano = 21'500'000'000},
                   {.name = "humidity", .unit = "%RH", .nano = 40'250'000'000}};
  node.heard_at = "2026-11-25T02:05:21Z";
  return node;
}

class FleetMemory : public testing::Test {
 protected:
  FleetMemory() {
    settings_.nodes_max = node_count;
    member_ = std::make_unique<FleetMember>(settings_, broker_, gateway_, gateway_, now_);
    member_->on_connected(now_);
    pass(5s);
  }

  // The broker takes all, and gives back what the member reads of its own.
  void pass(port::Duration time) {
    for (const port::Instant end = now_ + time; now_ < end;) {
      now_ += 500ms;
      member_->step(now_);
      broker_.deliver_all(now_);
      for (const RecordingBroker::Published& each : broker_.published) {
        member_->on_message({.topic = each.topic, .payload = each.payload}, now_);
      }
      broker_.published = {};
      broker_.delivered = 0;
    }
  }

  // By what is there beyond the member without nodes.
  static double bytes_a_node(const AllocationWatch& watch, const char* of_whom) {
    const double bytes = static_cast<double>(watch.held_bytes()) / node_count;
    std::printf("%s: %.0f bytes a node\n", of_whom, bytes);
    return bytes;
  }

  FleetSettings settings_ = member_settings();
  port::Instant now_{1h};
  QuietGateway gateway_;
  RecordingBroker broker_;
  std::unique_ptr<FleetMember> member_;
};

TEST_F(FleetMemory, ANodeThatThisGatewayHearsTakesNoMoreThanTheGuideSays) {
  const AllocationWatch watch;
  for (std::uint32_t serial = 1; serial <= node_count; ++serial) {
    ASSERT_TRUE(member_->hear(full_node(serial), now_));
  }
  pass(20s);
  constexpr std::array neighbours{Serial{1}, Serial{2}, Serial{3}, Serial{4}, Serial{5}, Serial{6}};
  for (std::uint32_t serial = 1; serial <= node_count; ++serial) {
    member_->set_neighbours(Serial{serial}, 1, neighbours);
  }
  pass(300s);
  ASSERT_EQ(member_->status().own_count, node_count);
  EXPECT_EQ(member_->status().waiting_count, 0u);
  EXPECT_LE(bytes_a_node(watch, "heard here"), own_bytes_max);
}

TEST_F(FleetMemory, ANodeThatAnotherGatewayHearsTakesNoMoreThanTheGuideSays) {
  const AllocationWatch watch;
  const std::string begin = "etcm/v1/yard/b/";
  FleetSetSummary set{.run = {.instance = 77, .epoch = 1}, .count = node_count};
  for (std::uint32_t serial = 1; serial <= node_count; ++serial) {
    const FleetRecord record{
        .node = full_node(serial), .owner = "b", .incarnation = 1, .sequence = 1, .is_heard = true};
    set.hash += record_hash(record);
    const std::string topic = begin + topic_tail(TopicKind::node, Serial{serial});
    member_->on_message({.topic = topic, .payload = encode_record(record)}, now_);
  }
  member_->on_message({.topic = begin + "set", .payload = encode_set(set)}, now_);
  pass(10s);
  ASSERT_EQ(member_->status().node_count, node_count);
  EXPECT_LE(bytes_a_node(watch, "heard elsewhere"), foreign_bytes_max);
}

}  // namespace
}  // namespace etcm::test
