// Whether a request of a client may go to the units of a bus that is shared (line_share.h).
#pragma once

#include <bitset>
#include <cstdint>
#include <span>

namespace etcm::port {

struct ClientRules {
  std::bitset<256> units;  // that may be asked; never 0: nobody answers a broadcast
  bool may_write = false;
};

// The exception to answer with, or 0: it may be sent. Whatever may be sent has the length and the
// counts that its function wants, so that the length of its answer is known.
// REQUIRES: `pdu` has at least one byte.
std::uint8_t judge(std::uint8_t address, std::span<const std::uint8_t> pdu,
                   const ClientRules& rules);

// Whether the request changes something in a unit.
bool is_write_request(std::span<const std::uint8_t> pdu);

}  // namespace etcm::port
