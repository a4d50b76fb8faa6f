// Modbus RTU framing: a unit, a PDU and a checksum, with silence around them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "modbus/frame.h"

namespace etcm::port {

inline constexpr std::size_t rtu_unit_bytes = 1;
inline constexpr std::size_t rtu_checksum_bytes = 2;
inline constexpr std::size_t rtu_frame_bytes_max =
    rtu_unit_bytes + pdu_bytes_max + rtu_checksum_bytes;

// The whole frame of a request to read registers, and of the answer to it.
inline constexpr std::size_t rtu_read_request_bytes = rtu_unit_bytes + 5 + rtu_checksum_bytes;
constexpr std::size_t rtu_read_answer_bytes(std::size_t register_count) {
  return rtu_unit_bytes + 2 + 2 * register_count + rtu_checksum_bytes;
}

// The whole frame of a request to write registers, and of the answer to it.
constexpr std::size_t rtu_write_request_bytes(std::size_t register_count) {
  return rtu_unit_bytes + 6 + 2 * register_count + rtu_checksum_bytes;
}
inline constexpr std::size_t rtu_write_answer_bytes = rtu_unit_bytes + 5 + rtu_checksum_bytes;

std::uint16_t rtu_checksum(std::span<const std::uint8_t> bytes);

// Whether these bytes are one frame: long enough, with the right checksum.
bool is_rtu_frame(std::span<const std::uint8_t> bytes);

// Writes unit and checksum around a PDU that already stands at frame[rtu_unit_bytes]; returns the
// length of the whole frame.
std::size_t wrap_rtu(std::span<std::uint8_t> frame, std::uint8_t address, std::size_t pdu_bytes);

// A frame inside of received bytes that looks like an answer to one of the functions of question.h.
struct RtuAnswer {
  std::uint8_t address = 0;
  std::span<const std::uint8_t> pdu;
  std::size_t end = 0;  // index of the first byte behind the frame
};

// The first such frame at or after `from`, whatever stands before it: noise, or an echo of the
// request. None while no whole one is there.
std::optional<RtuAnswer> find_rtu_answer(std::span<const std::uint8_t> bytes, std::size_t from = 0);

}  // namespace etcm::port
