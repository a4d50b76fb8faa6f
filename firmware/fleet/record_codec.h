// Records of nodes as JSON: schema/node.json.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "firmware/fleet/fleet_record.h"

namespace etcm::firmware {

// A record that is longer is not sound.
inline constexpr std::size_t record_bytes_max = 4096;

std::string encode_record(const FleetRecord& record);

// None, and what is wrong with it, for what is not a sound record of the node with this serial.
std::optional<FleetRecord> decode_record(std::string_view payload, Serial serial,
                                         std::string& wrong);

}  // namespace etcm::firmware
