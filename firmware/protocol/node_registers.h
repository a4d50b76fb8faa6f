// The registers of a position node: what the gateway reads, and what a node has to serve.
//
// Twelve input registers from 0, read in one request; holding registers that are written to a node:
// its unit, and its configuration. firmware/guide/registers.md has the tables.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "etcm/types.h"
#include "firmware/protocol/modbus_address.h"
#include "firmware/protocol/serial.h"

namespace etcm::firmware {

inline constexpr std::uint16_t node_register_first = 0;
inline constexpr std::uint16_t node_register_count = 12;
inline constexpr std::uint16_t node_magic = 0x4554;
inline constexpr std::uint8_t node_map_version = 1;

// A read may leave out so many registers from the first on: every node has the same there. The
// second of them still distinguishes a node from other devices; of a known node it can be left out.
inline constexpr std::uint16_t node_register_spare = 2;
inline constexpr std::uint16_t stranger_register_spare = 1;

// Where a new node answers until it is given a unit of its own.
inline constexpr ModbusAddress default_unit{247};

// New unit, serial, commit: written as a whole.
inline constexpr std::uint16_t assignment_register_first = 100;
inline constexpr std::uint16_t assignment_register_count = 4;

// Generation, count of neighbours, and their serials.
inline constexpr std::uint16_t configuration_register_first = 200;
inline constexpr std::uint16_t configuration_head_count = 3;
inline constexpr std::uint16_t configuration_neighbours_max = 120;
inline constexpr std::uint16_t configuration_register_count =
    configuration_head_count + 2 * configuration_neighbours_max;

namespace node_status {
inline constexpr std::uint16_t fix_valid = 1u << 0;
inline constexpr std::uint16_t moving = 1u << 1;
inline constexpr std::uint16_t join_request = 1u << 2;
inline constexpr std::uint16_t low_battery = 1u << 3;
inline constexpr std::uint16_t relay = 1u << 4;    // its role
inline constexpr std::uint16_t leaving = 1u << 5;  // wants to be taken out of the mesh
}  // namespace node_status

struct NodeReading {
  Serial serial;
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
  // Of other devices (firmware/profile):
  no_serial,      // its serial register has none
  off_the_plane,  // it is where the mesh cannot be
  other_axis,     // its longitude and its latitude are exchanged
};

// In which order the bytes of a 32-bit value come, A the highest. Where the bytes of a register are
// swapped (B before A), they are in all registers.
enum class WordOrder : std::uint8_t { abcd, badc, cdab, dcba };

// A serial as it reads when the words are taken in the wrong order.
constexpr Serial swap_words(Serial serial) {
  return Serial{serial.value << 16 | serial.value >> 16};
}

using NodeRegisters = std::array<std::uint16_t, node_register_count>;

// Sets `reading` only when there is no fault. A wrong byte order shows as swapped_bytes; a wrong
// word order only against the serial one expects. `left_out`: of the first registers, at most
// node_register_spare.
ReadingFault decode_node(std::span<const std::uint16_t> registers, WordOrder order,
                         NodeReading& reading, std::uint16_t left_out = 0);
NodeRegisters encode_node(const NodeReading& reading, std::uint16_t sequence);

using AssignmentRegisters = std::array<std::uint16_t, assignment_register_count>;

// The node with this serial shall answer at `unit` from now on.
AssignmentRegisters encode_assignment(ModbusAddress unit, Serial serial, WordOrder order);

// The same on the node's side: the new unit, where the values are for the node with this serial.
std::optional<ModbusAddress> decode_assignment(std::span<const std::uint16_t> values,
                                               Serial serial);

// What a node is told of the mesh; returns the count of registers written to the front of `out`.
// REQUIRES: at most configuration_neighbours_max neighbours; `out` has room for them.
std::size_t encode_configuration(std::uint32_t generation, std::span<const Serial> neighbours,
                                 WordOrder order, std::span<std::uint16_t> out);

// From one order to ABCD and back.
NodeRegisters reorder(const NodeRegisters& registers, WordOrder order);

// What is wrong, and what to do about it.
const char* explain(ReadingFault fault);

}  // namespace etcm::firmware
