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

// In which order the bytes of a 32-bit value come, A the highest. Where the bytes of a register are
// swapped (B before A), they are in all registers.
enum class WordOrder : std::uint8_t { abcd, badc, cdab, dcba };

// A serial as it reads when the words are taken in the wrong order.
constexpr std::uint32_t swap_words(std::uint32_t value) { return value << 16 | value >> 16; }

using NodeRegisters = std::array<std::uint16_t, node_register_count>;

// Sets `reading` only when there is no fault. A wrong byte order shows as swapped_bytes; a wrong
// word order only against the serial one expects.
ReadingFault decode_node(std::span<const std::uint16_t> registers, WordOrder order,
                         NodeReading& reading);
NodeRegisters encode_node(const NodeReading& reading, std::uint16_t sequence);

// From one order to ABCD and back.
NodeRegisters reorder(const NodeRegisters& registers, WordOrder order);

// What is wrong, and what to do about it.
const char* explain(ReadingFault fault);

}  // namespace etcm::firmware
