#include "modbus/frame.h"

#include <modbus/modbus.h>

#include <algorithm>

#include "etcm/port/node_bus.h"

namespace etcm::port {

static_assert(frame_bytes_max == MODBUS_TCP_MAX_ADU_LENGTH);
static_assert(read_holding_registers == MODBUS_FC_READ_HOLDING_REGISTERS);
static_assert(read_input_registers == MODBUS_FC_READ_INPUT_REGISTERS);
static_assert(write_holding_registers == MODBUS_FC_WRITE_MULTIPLE_REGISTERS);
static_assert(read_registers_max == MODBUS_MAX_READ_REGISTERS);
static_assert(write_registers_max == MODBUS_MAX_WRITE_REGISTERS);

namespace {

// Function, first register, count and the count of the bytes that follow.
constexpr std::size_t write_request_head = 6;

std::uint16_t load(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] << 8 | bytes[at + 1]);
}

void store(std::span<std::uint8_t> bytes, std::size_t at, std::uint16_t value) {
  bytes[at] = static_cast<std::uint8_t>(value >> 8);
  bytes[at + 1] = static_cast<std::uint8_t>(value & 0xff);
}

}  // namespace

std::span<std::uint8_t> FrameReader::free_space() {
  if (begin_ > 0) {
    std::copy(bytes_.begin() + static_cast<std::ptrdiff_t>(begin_),
              bytes_.begin() + static_cast<std::ptrdiff_t>(end_), bytes_.begin());
    end_ -= begin_;
    begin_ = 0;
  }
  return std::span(bytes_).subspan(end_);
}

void FrameReader::received(std::size_t count) { end_ += count; }

FrameReader::Next FrameReader::next(Frame& frame) {
  const auto held = std::span<const std::uint8_t>(bytes_).subspan(begin_, end_ - begin_);
  if (held.size() < mbap_header_bytes) return Next::incomplete;
  const std::uint16_t protocol = load(held, 2);
  const std::uint16_t length = load(held, 4);  // of the unit and the PDU
  if (protocol != 0 || length < 2 || length > 1 + pdu_bytes_max) return Next::broken;
  const std::size_t whole = mbap_header_bytes - 1 + length;
  if (held.size() < whole) return Next::incomplete;
  frame = {.transaction = load(held, 0),
           .address = held[6],
           .pdu = held.subspan(mbap_header_bytes, length - 1u)};
  begin_ += whole;
  return Next::frame;
}

std::size_t write_header(std::span<std::uint8_t> frame, std::uint16_t transaction,
                         std::uint8_t address, std::size_t pdu_bytes) {
  store(frame, 0, transaction);
  store(frame, 2, 0);
  store(frame, 4, static_cast<std::uint16_t>(pdu_bytes + 1));
  frame[6] = address;
  return mbap_header_bytes + pdu_bytes;
}

std::size_t write_read_request(std::span<std::uint8_t> pdu, std::uint8_t function,
                               RegisterRange range) {
  pdu[0] = function;
  store(pdu, 1, range.first);
  store(pdu, 3, range.count);
  return 5;
}

std::optional<RegisterRange> parse_read_request(std::span<const std::uint8_t> pdu,
                                                std::uint8_t& exception) {
  if (pdu[0] != read_input_registers && pdu[0] != read_holding_registers) {
    exception = MODBUS_EXCEPTION_ILLEGAL_FUNCTION;
    return std::nullopt;
  }
  exception = MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE;
  if (pdu.size() != 5) return std::nullopt;
  const RegisterRange range{.first = load(pdu, 1), .count = load(pdu, 3)};
  if (range.count == 0 || range.count > read_registers_max) return std::nullopt;
  return range;
}

std::size_t write_exception(std::span<std::uint8_t> pdu, std::uint8_t function,
                            std::uint8_t exception) {
  pdu[0] = function | exception_bit;
  pdu[1] = exception;
  return 2;
}

ReadAnswer parse_read_answer(std::span<const std::uint8_t> pdu, std::uint8_t function,
                             std::span<std::uint16_t> registers, std::uint8_t& exception) {
  if (pdu.size() == 2 && pdu[0] == (function | exception_bit)) {
    exception = pdu[1];
    return ReadAnswer::exception;
  }
  if (pdu.size() != 2 + 2 * registers.size() || pdu[0] != function ||
      pdu[1] != 2 * registers.size()) {
    return ReadAnswer::malformed;
  }
  for (std::size_t i = 0; i < registers.size(); ++i) registers[i] = load(pdu, 2 + 2 * i);
  return ReadAnswer::registers;
}

std::size_t write_write_request(std::span<std::uint8_t> pdu, std::uint16_t first,
                                std::span<const std::uint16_t> values) {
  pdu[0] = write_holding_registers;
  store(pdu, 1, first);
  store(pdu, 3, static_cast<std::uint16_t>(values.size()));
  pdu[5] = static_cast<std::uint8_t>(2 * values.size());
  std::size_t at = write_request_head;
  for (const std::uint16_t value : values) {
    store(pdu, at, value);
    at += 2;
  }
  return at;
}

std::optional<RegisterRange> parse_write_request(std::span<const std::uint8_t> pdu,
                                                 std::uint8_t& exception) {
  if (pdu[0] != write_holding_registers) {
    exception = MODBUS_EXCEPTION_ILLEGAL_FUNCTION;
    return std::nullopt;
  }
  exception = MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE;
  if (pdu.size() < write_request_head) return std::nullopt;
  const RegisterRange range{.first = load(pdu, 1), .count = load(pdu, 3)};
  if (range.count == 0 || range.count > write_registers_max) return std::nullopt;
  const std::size_t bytes = std::size_t{2} * range.count;
  if (pdu[5] != bytes || pdu.size() != write_request_head + bytes) return std::nullopt;
  return range;
}

WriteAnswer parse_write_answer(std::span<const std::uint8_t> pdu, RegisterRange range,
                               std::uint8_t& exception) {
  if (pdu.size() == 2 && pdu[0] == (write_holding_registers | exception_bit)) {
    exception = pdu[1];
    return WriteAnswer::exception;
  }
  if (pdu.size() != 5 || pdu[0] != write_holding_registers || load(pdu, 1) != range.first ||
      load(pdu, 3) != range.count) {
    return WriteAnswer::malformed;
  }
  return WriteAnswer::written;
}

}  // namespace etcm::port
