// Prints what members say, a message a line: kind, blank, payload. For schema_test.py.
#include <cstdio>
#include <memory>

#include "firmware/alarms/alarm_teller.h"
#include "firmware/fleet/fleet_hash.h"
#include "firmware/fleet/fleet_member.h"
#include "firmware/fleet/fleet_topics.h"
#include "firmware/fleet/header_codec.h"
#include "firmware/fleet/record_codec.h"
#include "recording_broker.h"

namespace etcm::test {
namespace {

using namespace std::chrono_literals;
using namespace etcm::firmware;

class Sampler {
 public:
  Sampler() {
    settings_.site = "yard";
    settings_.gateway = "gate.1";
    settings_.instance = 0xfedcba9876543210;
    settings_.version = "1.2.3";
    settings_.report_min = 0s;
    member_ = std::make_unique<FleetMember>(settings_, broker_, gateway_, gateway_, now_);
  }

  void run() {
    std::printf("header %s\n", broker_.will.c_str());
    member_->on_connected(now_);
    pass(5s);
    speak();
    pass(40s);
    say("b/node/00000007",
        R"({"serial":7,"owner":"b","incarnation":1,"sequence":1,"heard":true,"age":0,"status":0})");
    say("b/set",
        R"({"instance":"0000000000000001","epoch":1,"count":2,"hash":"0000000000000001"})");
    for (int beat = 1; beat < 4; ++beat) {
      say("b/header", R"({"instance":"0000000000000001","epoch":1,"online":true,)"
                      R"("merged":{"count":0,"hash":"0000000000000000"},)"
                      R"("mesh":{"generation":0,"hash":"0000000000000000"},)"
                      R"("site":{"number":0,"hash":"0000000000000000"},"beat":)" +
                          std::to_string(beat) + "}");
      pass(30s);
    }
    clash();
    for (int beat = 1; beat < 4; ++beat) {
      say("gate.1/header", R"({"instance":"ffffffffffffffff","epoch":1,"online":true,)"
                           R"("other":"fedcba9876543210",)"
                           R"("merged":{"count":0,"hash":"0000000000000000"},)"
                           R"("mesh":{"generation":0,"hash":"0000000000000000"},)"
                           R"("site":{"number":0,"hash":"0000000000000000"},"beat":)" +
                               std::to_string(beat) + "}");
      pass(30s);
    }
    for (const auto& each : broker_.published) {
      const auto topic = parse_topic(each.topic, settings_.site);
      if (!topic || each.payload.empty()) continue;
      std::string kind = topic_tail(topic->kind, topic->serial);
      kind = kind.substr(0, kind.find('/'));
      std::printf("%s %s\n", kind.c_str(), each.payload.c_str());
    }
  }

 private:
  // Another one speaks for nodes that are heard here in another place; some of them it keeps.
  void clash() {
    FleetHeader header{.run = {.instance = 3, .epoch = 1}, .beat = 1, .is_online = true};
    FleetSetSummary set{.run = header.run, .count = 8};
    for (std::uint32_t serial = 20; serial < 28; ++serial) {
      const FleetRecord record{.node = {.serial = Serial{serial}, .position = Position{900, 900}},
                               .owner = "c",
                               .incarnation = 9,
                               .sequence = 1,
                               .is_heard = true};
      set.hash += record_hash(record);
      say("c/" + topic_tail(TopicKind::node, Serial{serial}), encode_record(record));
    }
    say("c/set", encode_set(set));
    say("c/header", encode_header(header));
    for (int second = 0; second < 20; ++second) {
      for (std::uint32_t serial = 20; serial < 28; ++serial) {
        const bool is_taken =
            member_->hear({.serial = Serial{serial}, .position = Position{-900, 0}}, now_);
        if (!is_taken) std::printf("not taken\n");
        if (second == 2) {
          FleetRecord record = *member_->find(Serial{serial});
          record.owner = "c";
          record.node.position = Position{900, 900};
          ++record.sequence;
          say("c/" + topic_tail(TopicKind::node, Serial{serial}), encode_record(record));
        }
      }
      pass(1s);
    }
  }

  void speak() {
    FleetNode node{.serial = Serial{1001},
                   .name = "pump \"house\"",
                   .position = Position{.x = -5, .y = 7},
                   .longitude = "-0.25",
                   .latitude = "51",
                   .status = 9,
                   .readings = {{.name = "temp \"in\"", .unit = "°C", .nano = -1'500'000'000},
                                {.name = "level", .unit = "m", .nano = std::nullopt}},
                   .heard_at = "2026-03-01T12:00:00Z",
                   .age_s = 1};
    const bool is_taken = member_->hear(node, now_) &&
                          member_->hear({.serial = Serial{0}, .position = std::nullopt}, now_) &&
                          member_->hear({.serial = Serial{5}, .position = Position{}}, now_);
    if (!is_taken) std::printf("not taken\n");
    member_->remove(Serial{5}, LeftReason::silent, now_);
    pass(1s);
    const Serial neighbours[] = {Serial{0}};
    member_->set_neighbours(Serial{1001}, 3, neighbours);
    member_->set_alarms(alarms());
    member_->set_mesh(3, 0x1234567890abcdef, 2);
    SiteDocument site{.plane = {.crs = "EPSG:25833", .unit = 10'000'000, .x = 390'000'000'000'000}};
    site.anchors = {{1, 2}};
    site.features = {{.from = Serial{1001}, .to = FeatureEnd::anchor({1, 2}), .name = "fence"}};
    site.outline = {{.from = to_point(Position{0, 0}), .to = to_point(Position{9, 0})}};
    member_->set_site(site, true, now_);
    pass(40s);
    site.plane = {.is_about_place = true, .unit = 1'000'000'000, .x = 13'377'000'000};
    member_->set_site(site, true, now_);
    pass(1s);
  }

  // One has a cure, and began now; of the other it is not known when.
  std::string alarms() const {
    Alarm bus, node;
    bus.key = {.kind = AlarmKind::silent_bus, .subject = 9};
    bus.severity = Severity::critical;
    bus.since.at = now_;
    node.key = {.kind = AlarmKind::missing_node, .subject = 5};
    node.severity = Severity::major;
    if (!bus.set_words("bus \"yard\" is silent", "look\nat its cable") ||
        !node.set_words("node 5 is missing", "")) {
      std::printf("not taken\n");
    }
    const Alarm* const both[] = {&bus, &node};
    return encode_told_alarms(both, 3, now_, 1'800'000'000'000);
  }

  void pass(port::Duration time) {
    for (const port::Instant end = now_ + time; now_ < end;) {
      now_ += 500ms;
      member_->step(now_);
      broker_.deliver_all(now_);
    }
  }
  void say(const std::string& topic, const std::string& payload) {
    member_->on_message({.topic = "etcm/v1/yard/" + topic, .payload = payload}, now_);
  }

  FleetSettings settings_;
  port::Instant now_{1h};
  RecordingGateway gateway_;
  RecordingBroker broker_;
  std::unique_ptr<FleetMember> member_;
};

}  // namespace
}  // namespace etcm::test

int main() { etcm::test::Sampler().run(); }
