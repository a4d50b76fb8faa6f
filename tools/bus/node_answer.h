// A unit asked as the gateway asks position nodes.
#pragma once

#include <optional>
#include <string>

#include "firmware/protocol/node_registers.h"
#include "master.h"

namespace etcm::bus {

struct NodeAnswer {
  std::optional<ErrorDetail> error_detail;                      // there were no registers
  firmware::ReadingFault fault = firmware::ReadingFault::none;  // there were, but not a node's
  firmware::NodeReading reading;

  bool is_node() const { return !error_detail && fault == firmware::ReadingFault::none; }
};

// Torn reads are repeated, as the gateway does.
NodeAnswer ask_node(Master& master, std::uint8_t unit, firmware::WordOrder order);

// Why it is not a sound node; empty where it is one.
std::string trouble_text(const NodeAnswer& answer);

// "fix, moving, low battery"; "no fix" where the position does not count.
std::string status_text(std::uint16_t status);

}  // namespace etcm::bus
