// What people call things: a line of text that fits a log, a page and a label.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "firmware/config/settings.h"
#include "firmware/fleet/fleet_record.h"

namespace etcm::firmware {

// In UTF-8.
inline constexpr std::size_t name_bytes_max = node_name_max;

// It has a byte at least and name_bytes_max at most, and no character that cannot be seen or that
// turns the writing of what stands behind it. REQUIRES: UTF-8.
bool is_name(std::string_view text);

// A map's name as one that fits: what is_name() forbids becomes a space, and it is cut.
std::string name_of_map(std::string_view text);

// Adds what somebody calls a node; without a bus its unit is on the only one. A name that is there
// already may come once more. If it is wrong, the answer is as add_node() has it.
NodeMistake add_name(Settings& settings, NodeName name);

}  // namespace etcm::firmware
