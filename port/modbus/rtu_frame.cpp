#include "modbus/rtu_frame.h"

#include <modbus/modbus.h>

#include <array>

#include "modbus/identity.h"
#include "modbus/question.h"

namespace etcm::port {

static_assert(rtu_frame_bytes_max == MODBUS_RTU_MAX_ADU_LENGTH);

namespace {

constexpr std::uint16_t checksum_polynomial = 0xa001;  // x^16 + x^15 + x^2 + 1, low bit first

constexpr std::array<std::uint16_t, 256> make_checksum_table() {
  std::array<std::uint16_t, 256> table{};
  for (unsigned byte = 0; byte < table.size(); ++byte) {
    unsigned value = byte;
    for (int bit = 0; bit < 8; ++bit) {
      value = (value & 1u) != 0 ? (value >> 1) ^ checksum_polynomial : value >> 1;
    }
    table[byte] = static_cast<std::uint16_t>(value);
  }
  return table;
}

constexpr std::array<std::uint16_t, 256> checksum_table = make_checksum_table();

// How long the PDU of FC 43/14 is that starts with these bytes; 0 while its texts are not all
// there.
std::size_t identification_bytes(std::span<const std::uint8_t> pdu) {
  constexpr std::size_t header_bytes = 7;
  constexpr std::size_t object_head = 2;
  if (pdu.size() < header_bytes || pdu[1] != read_device_identification) return 0;
  std::size_t end = header_bytes;
  for (int left = pdu[6]; left > 0; --left) {
    if (end + object_head > pdu.size()) return 0;
    end += object_head + pdu[end + 1];
  }
  return end;
}

// How long the PDU of an answer would be that starts with these two bytes or more; 0 where none
// starts so, or more are needed to tell.
std::size_t answer_pdu_bytes(std::span<const std::uint8_t> pdu) {
  constexpr std::uint8_t failed_bit = 0x80;
  const std::uint8_t function = pdu[0] & static_cast<std::uint8_t>(~failed_bit);
  std::size_t size = 0;
  switch (function) {
    case read_holding_registers:
    case read_input_registers:
    case write_and_read_registers:
      size = pdu[1] % 2 == 0 ? 2u + pdu[1] : 0u;
      break;
    case write_single_coil:
    case write_single_register:
    case write_coils:
    case write_holding_registers:
    case mask_write_register:
      size = answer_bytes({.function = function, .range = {}});
      break;
    case read_coils:
    case read_discrete_inputs:
    case report_server_id:
      size = 2u + pdu[1];
      break;
    case encapsulated_interface:
      size = identification_bytes(pdu);
      break;
    default:
      return 0;
  }
  return function == pdu[0] ? size : 2;
}

}  // namespace

std::uint16_t rtu_checksum(std::span<const std::uint8_t> bytes) {
  std::uint16_t value = 0xffff;
  for (const std::uint8_t byte : bytes) {
    value = static_cast<std::uint16_t>(value >> 8 ^ checksum_table[(value ^ byte) & 0xff]);
  }
  return value;
}

bool is_rtu_frame(std::span<const std::uint8_t> bytes) {
  if (bytes.size() <= rtu_unit_bytes + rtu_checksum_bytes) return false;
  // The checksum comes low byte first, so that of the whole frame is 0.
  return rtu_checksum(bytes) == 0;
}

std::size_t wrap_rtu(std::span<std::uint8_t> frame, std::uint8_t address, std::size_t pdu_bytes) {
  frame[0] = address;
  const std::size_t checked = rtu_unit_bytes + pdu_bytes;
  const std::uint16_t checksum = rtu_checksum(frame.first(checked));
  frame[checked] = static_cast<std::uint8_t>(checksum & 0xff);
  frame[checked + 1] = static_cast<std::uint8_t>(checksum >> 8);
  return checked + rtu_checksum_bytes;
}

std::optional<RtuAnswer> find_rtu_answer(std::span<const std::uint8_t> bytes, std::size_t from) {
  for (std::size_t begin = from; begin + 3 <= bytes.size(); ++begin) {
    const std::span<const std::uint8_t> rest = bytes.subspan(begin);
    const std::size_t pdu = answer_pdu_bytes(rest.subspan(rtu_unit_bytes));
    const std::size_t size = rtu_unit_bytes + pdu + rtu_checksum_bytes;
    if (pdu == 0 || size > rest.size() || !is_rtu_frame(rest.first(size))) continue;
    return RtuAnswer{
        .address = rest[0], .pdu = rest.subspan(rtu_unit_bytes, pdu), .end = begin + size};
  }
  return std::nullopt;
}

}  // namespace etcm::port
