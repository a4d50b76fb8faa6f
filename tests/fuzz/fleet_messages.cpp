// What other members of a fleet say, or whoever can write to the broker. Each line is one step:
//   TOPIC PAYLOAD   a message on etcm/v1/yard/TOPIC
//   +N              so many half seconds pass
//   =N X            the node N is heard here, at X
//   ~               the connection is lost, and comes back
//   *NAME           the member NAME says that its set is what it has said of nodes
#include <charconv>
#include <map>
#include <string>
#include <string_view>

#include "firmware/fleet/fleet_hash.h"
#include "firmware/fleet/fleet_member.h"
#include "firmware/fleet/fleet_topics.h"
#include "firmware/fleet/header_codec.h"
#include "firmware/fleet/record_codec.h"
#include "firmware/fleet/site_codec.h"
#include "fleet/recording_broker.h"
#include "fuzz_target.h"

namespace etcm::fuzz {
namespace {

using namespace std::chrono_literals;
using namespace firmware;

FleetSettings settings_of_a() {
  FleetSettings settings{.site = "yard", .gateway = "a", .instance = 10};
  settings.nodes_max = 20;
  settings.members_max = 4;
  return settings;
}

std::string_view take(std::string_view& text, char end) {
  const std::string_view part = text.substr(0, text.find(end));
  text.remove_prefix(std::min(part.size() + 1, text.size()));
  return part;
}

std::int32_t number(std::string_view text) {
  std::int32_t value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

// What is sound is said again in the same way.
void decode(const FleetTopic& topic, std::string_view payload) {
  std::string wrong;
  if (const auto record = decode_record(payload, topic.serial, wrong)) {
    const auto again = decode_record(encode_record(*record), topic.serial, wrong);
    require(again && compare(*again, *record) == 0 && has_same_content(again->node, record->node),
            "a record is another one");
  }
  if (const auto set = decode_set(payload, wrong)) {
    require(decode_set(encode_set(*set), wrong) == set, "a set is another one");
  }
  if (const auto header = decode_header(payload, wrong)) {
    require(decode_header(encode_header(*header), wrong).has_value(), "a header is not read");
  }
  if (const auto run = decode_conflict(payload, wrong)) {
    require(decode_conflict(encode_conflict(*run), wrong) == run, "a conflict is another one");
  }
  if (const auto have = decode_have(payload, wrong)) {
    require(decode_have(encode_have(*have), wrong).has_value(), "a list is not read");
  }
  if (const auto site = decode_site(payload, wrong)) {
    require(decode_site(encode_site(*site), wrong) == site, "a site is another one");
  }
}

class Member {
 public:
  Member() { member_.on_connected(now_); }

  void step(std::string_view line) {
    if (line.empty()) return;
    if (line[0] == '+') return pass(number(line.substr(1)));
    if (line[0] == '=') return hear(line.substr(1));
    if (line[0] == '~') {
      member_.on_disconnected("the cable", now_);
      return member_.on_connected(now_);
    }
    if (line[0] == '*') return say_set(std::string(line.substr(1)));
    const std::string topic = "etcm/v1/yard/" + std::string(take(line, ' '));
    if (const auto parsed = parse_topic(topic, "yard")) {
      require(topic_text("yard", *parsed) == topic, "a topic is another one");
      decode(*parsed, line);
      if (parsed->kind == TopicKind::node) note_record(*parsed, line);
    }
    member_.on_message({.topic = topic, .payload = line, .retained = topic.size() % 2 == 0}, now_);
  }
  void check() {
    const FleetSettings settings = settings_of_a();
    std::uint32_t count = 0;
    member_.for_each_node([&](const FleetRecord&, bool) { ++count; });
    const FleetStatus status = member_.status();
    require(count == status.node_count && count <= settings.nodes_max, "nodes beyond the room");
    require(member_.peers().size() <= settings.members_max, "members beyond the room");
    const std::vector<std::byte> saved = member_.save();
    require(saved.size() <= save_bytes_max(settings), "it saves more than it says");
    test::RecordingBroker broker;
    test::RecordingGateway gateway;
    FleetMember other(settings, broker, gateway, gateway, now_);
    require(other.restore(saved, now_).empty(), "what was saved is not read");
    require(other.status().merged_hash == status.merged_hash, "what was saved is something else");
  }
  void pass(std::int32_t steps) {
    for (std::int32_t i = 0; i < std::min(steps, 250); ++i) {
      now_ += 500ms;
      member_.step(now_);
      broker_.deliver_all(now_);
    }
  }

 private:
  void note_record(const FleetTopic& topic, std::string_view payload) {
    auto& said = said_[std::string(topic.gateway)];
    std::string wrong;
    const auto record = decode_record(payload, topic.serial, wrong);
    if (record) {
      said[topic.serial] = record_hash(*record);
    } else {
      said.erase(topic.serial);
    }
  }
  // No bytes at random would have its hash.
  void say_set(const std::string& name) {
    FleetSetSummary set{.run = {.instance = 77, .epoch = 1}};
    for (const auto& [serial, hash] : said_[name]) {
      ++set.count;
      set.hash += hash;
    }
    const std::string topic = "etcm/v1/yard/" + name + "/set", payload = encode_set(set);
    member_.on_message({.topic = topic, .payload = payload, .retained = true}, now_);
  }
  void hear(std::string_view text) {
    const Serial serial{static_cast<std::uint32_t>(number(take(text, ' ')))};
    const FleetNode node{.serial = serial, .position = Position{.x = number(text), .y = 0}};
    static_cast<void>(member_.hear(node, now_));
  }

  port::Instant now_{1h};
  std::map<std::string, std::map<Serial, std::uint64_t>> said_;  // hashes of records, by who
  test::RecordingBroker broker_;
  test::RecordingGateway gateway_;
  FleetMember member_{settings_of_a(), broker_, gateway_, gateway_, now_};
};

}  // namespace

void run(std::span<const std::uint8_t> bytes) {
  std::string_view text = text_of(bytes);
  Member member;
  for (int line = 0; line < 100 && !text.empty(); ++line) member.step(take(text, '\n'));
  member.pass(10);
  member.check();
}

}  // namespace etcm::fuzz
