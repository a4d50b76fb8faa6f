// The registers of a position node: what the gateway reads, and what a node has to serve.
//
// Twelve input registers from 0, read in one request; firmware/README.md has the table.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "etcm/types.h"

namespace etcm::firmware {

inline constexpr std::uint16_t node_register_first = 0;
inline constexpr std::uint16_t node_register_count = 12;
inline constexpr std::uint16_t node_magic = 0x4554;
inline constexpr std::uint8_t node_map_version = 1;

// No node has this serial.
inline constexpr std::uint32_t no_serial = 0xffffffff;

namespace node_status {
inline constexpr std::uint16_t fix_valid = 1u << 0;
inline constexpr std::uint16_t moving = 1u << 1;
inline constexpr std::uint16_t join_request = 1u << 2;
inline constexpr std::uint16_t low_battery = 1u << 3;
inline constexpr std::uint16_t relay = 1u << 4;    // its role
inline constexpr std::uint16_t leaving = 1u << 5;  // wants to be taken out of the mesh
}  // namespace node_status

struct NodeReading {
  std::uint32_t serial = no_serial;
  Position position;
  std::uint16_t status = 0;
  std::uint16_t boot_count = 0;
};

enum class ReadingFault : std::uint8_t {
  none,
  wrong_length,
  wrong_magic,
  swapped_bytes,  // the magic has its bytes exchanged
  wrong_version,
  torn,  // the node changed the registers while they were read: read again
  bad_serial,
  bad_position,  // |x| or |y| above position_max while the fix is valid
};

using NodeRegisters = std::array<std::uint16_t, node_register_count>;

// Sets `reading` only when there is no fault.
ReadingFault decode_node(std::span<const std::uint16_t> registers, NodeReading& reading);
NodeRegisters encode_node(const NodeReading& reading, std::uint16_t sequence);

// What is wrong, and what to do about it.
const char* explain(ReadingFault fault);

}  // namespace etcm::firmware
