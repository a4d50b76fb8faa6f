#include "firmware/protocol/node_registers.h"

#include <algorithm>
#include <utility>

#include "firmware/protocol/register_pairs.h"

namespace etcm::firmware {

namespace {

// Offsets into the twelve registers.
constexpr std::size_t at_magic = 0;
constexpr std::size_t at_version = 1;  // version << 8 | count of registers
constexpr std::size_t at_serial = 2;
constexpr std::size_t at_sequence_before = 4;
constexpr std::size_t at_x = 5;
constexpr std::size_t at_y = 7;
constexpr std::size_t at_status = 9;
constexpr std::size_t at_boot_count = 10;
constexpr std::size_t at_sequence_after = 11;

constexpr std::uint16_t swap_bytes(std::uint16_t value) {
  return static_cast<std::uint16_t>(value << 8 | value >> 8);
}
constexpr std::uint16_t version_and_length = node_map_version << 8 | node_register_count;

// Offsets into the registers of an assignment.
constexpr std::size_t at_new_unit = 0;
constexpr std::size_t at_serial_match = 1;
constexpr std::size_t at_commit = 3;

void reorder_bytes(std::span<std::uint16_t> registers, WordOrder order) {
  if (order != WordOrder::badc && order != WordOrder::dcba) return;
  std::transform(registers.begin(), registers.end(), registers.begin(), swap_bytes);
}

// Of the 32-bit value there.
void reorder_words(std::span<std::uint16_t> registers, std::size_t at, WordOrder order) {
  if (order != WordOrder::cdab && order != WordOrder::dcba) return;
  std::swap(registers[at], registers[at + 1]);
}

}  // namespace

NodeRegisters reorder(const NodeRegisters& registers, WordOrder order) {
  NodeRegisters ordered = registers;
  reorder_bytes(ordered, order);
  for (const std::size_t at : {at_serial, at_x, at_y}) reorder_words(ordered, at, order);
  return ordered;
}

AssignmentRegisters encode_assignment(ModbusAddress unit, Serial serial, WordOrder order) {
  AssignmentRegisters registers{};
  registers[at_new_unit] = unit.value;
  store_u32(registers, at_serial_match, serial.value);
  registers[at_commit] = node_magic;
  reorder_bytes(registers, order);
  reorder_words(registers, at_serial_match, order);
  return registers;
}

std::optional<ModbusAddress> decode_assignment(std::span<const std::uint16_t> values,
                                               Serial serial) {
  if (values.size() != assignment_register_count || values[at_commit] != node_magic ||
      load_u32(values, at_serial_match) != serial.value || values[at_new_unit] < 1 ||
      values[at_new_unit] > default_unit.value) {
    return std::nullopt;
  }
  return ModbusAddress{static_cast<std::uint8_t>(values[at_new_unit])};
}

std::size_t encode_configuration(std::uint32_t generation, std::span<const Serial> neighbours,
                                 WordOrder order, std::span<std::uint16_t> out) {
  const std::size_t count = configuration_head_count + 2 * neighbours.size();
  const auto registers = out.first(count);
  store_u32(registers, 0, generation);
  registers[2] = static_cast<std::uint16_t>(neighbours.size());
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    store_u32(registers, configuration_head_count + 2 * i, neighbours[i].value);
  }
  reorder_bytes(registers, order);
  reorder_words(registers, 0, order);
  for (std::size_t at = configuration_head_count; at < count; at += 2) {
    reorder_words(registers, at, order);
  }
  return count;
}

ReadingFault decode_node(std::span<const std::uint16_t> received, WordOrder order,
                         NodeReading& reading, std::uint16_t left_out) {
  if (received.size() + left_out != node_register_count) return ReadingFault::wrong_length;
  NodeRegisters registers{};
  std::copy(received.begin(), received.end(), registers.begin() + left_out);
  registers = reorder(registers, order);
  if (left_out > at_magic) registers[at_magic] = node_magic;
  if (left_out > at_version) registers[at_version] = version_and_length;
  if (registers[at_magic] == swap_bytes(node_magic)) return ReadingFault::swapped_bytes;
  if (registers[at_magic] != node_magic) return ReadingFault::wrong_magic;
  if (registers[at_version] != version_and_length) return ReadingFault::wrong_version;
  if (registers[at_sequence_before] != registers[at_sequence_after]) return ReadingFault::torn;
  const NodeReading found{.serial = Serial{load_u32(registers, at_serial)},
                          .position = {.x = static_cast<std::int32_t>(load_u32(registers, at_x)),
                                       .y = static_cast<std::int32_t>(load_u32(registers, at_y))},
                          .status = registers[at_status],
                          .boot_count = registers[at_boot_count]};
  if (found.serial.is_none()) return ReadingFault::bad_serial;
  if ((found.status & node_status::fix_valid) != 0 && !in_range(found.position)) {
    return ReadingFault::bad_position;
  }
  reading = found;
  return ReadingFault::none;
}

NodeRegisters encode_node(const NodeReading& reading, std::uint16_t sequence) {
  NodeRegisters registers{};
  registers[at_magic] = node_magic;
  registers[at_version] = version_and_length;
  store_u32(registers, at_serial, reading.serial.value);
  registers[at_sequence_before] = sequence;
  store_u32(registers, at_x, static_cast<std::uint32_t>(reading.position.x));
  store_u32(registers, at_y, static_cast<std::uint32_t>(reading.position.y));
  registers[at_status] = reading.status;
  registers[at_boot_count] = reading.boot_count;
  registers[at_sequence_after] = sequence;
  return registers;
}

const char* explain(ReadingFault fault) {
  switch (fault) {
    case ReadingFault::none:
      return "ok";
    case ReadingFault::wrong_length:
      return "the answer has not 12 registers";
    case ReadingFault::wrong_magic:
      return "register 0 is not 0x4554: no position node, take it out of `units`";
    case ReadingFault::swapped_bytes:
      return "register 0 has its bytes swapped: set `word_order` of the bus (ABCD <-> BADC, CDAB "
             "<-> DCBA)";
    case ReadingFault::wrong_version:
      return "register 1 is not 0x010C: the node needs firmware with map version 1";
    case ReadingFault::torn:
      return "torn read: registers 4 and 11 differ";
    case ReadingFault::bad_serial:
      return "serial 0xFFFFFFFF: give the node a serial";
    case ReadingFault::bad_position:
      return "position beyond +-16777216 units: correct `word_order` of the bus, or the node's "
             "origin or "
             "unit";
    case ReadingFault::no_serial:
      return "no serial in the registers of `serial`: correct its profile, or take `serial` out; "
             "one "
             "of letters is read as type = \"u32\"";
    case ReadingFault::off_the_plane:
      return "its place is beyond the plane of the mesh: correct 'order', 'scale' or 'format' in "
             "its profile, or exchange its longitude and latitude there (etcm-bus probe shows what "
             "each is); if it does stand there, set `origin` in [site] to a corner of the site, or "
             "a greater `unit`";
    case ReadingFault::other_axis:
      return "the letter of a hemisphere is not one of its coordinate: exchange the registers of "
             "'longitude' and 'latitude' in the profile, or their letters";
  }
  return "";
}

}  // namespace etcm::firmware
