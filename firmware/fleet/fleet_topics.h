// The topics of a fleet: etcm/v1/<site>/site, and below etcm/v1/<site>/<gateway>/ what each member
// publishes. A member writes to its own topics and to the one of the site.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/protocol/serial.h"

namespace etcm::firmware {

// In the order in which they are sent where several are due at a time.
enum class TopicKind : std::uint8_t {
  node,        // a record, by serial
  set,         // how many messages there are about its nodes, and their hash
  header,      // that a member is there, and what it knows; replaced by its last will
  site,        // the document that all share
  neighbours,  // of a node that it owns, by serial
  alarms,
  clashes,   // serials that it hears and another member speaks for, in another place
  conflict,  // a program that shares its name with another one, and is read-only
  have,      // what a member has of another one whose set is not complete
};

struct FleetTopic {
  TopicKind kind = TopicKind::header;
  std::string_view gateway{};  // but for `site`
  Serial serial{};             // of `node` and `neighbours`
  std::string_view other{};    // the gateway that `have` is about
};

// None for a topic of another site, or that this version does not know.
std::optional<FleetTopic> parse_topic(std::string_view topic, std::string_view site);
std::string topic_text(std::string_view site, const FleetTopic& topic);
// What a member subscribes to: all but the neighbours and alarms of others, which are for those who
// read along. They are more than half of what is said, and a broker gives each subscriber a bounded
// number of messages at a time (Mosquitto: max_queued_messages).
std::vector<std::string> member_filters(std::string_view site, std::string_view gateway);
// "node/000003e9": what follows the gateway.
std::string topic_tail(TopicKind kind, Serial serial);

}  // namespace etcm::firmware
