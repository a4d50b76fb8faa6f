// How Home Assistant is told of a node (its documentation: MQTT discovery, device discovery).
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/protocol/serial.h"

namespace etcm::firmware {

struct AnnouncedReading {
  std::string_view name;
  std::string_view unit{};  // or empty
};

// Where the record of a node stands, and what it has.
struct AnnouncedNode {
  std::string_view site;
  std::string_view gateway;
  Serial serial;
  std::string_view name{};  // what people call it, or empty
  bool has_degrees = false;
  std::span<const AnnouncedReading> readings{};
};

// The topic of the message about this node; `prefix` is where Home Assistant looks for them.
std::string announcement_topic(std::string_view prefix, std::string_view site, Serial serial);

// The message: JSON. Each entity shows a part of the node's record (record_codec.h) and is
// unavailable while the header of the gateway (header_codec.h) says that it is not online.
std::string announcement(const AnnouncedNode& node, std::string_view version);

}  // namespace etcm::firmware
