#include "modbus/question.h"

#include "modbus/identity.h"

namespace etcm::port {

namespace {

// What stands in the answer to a function.
enum class AnswerKind : std::uint8_t { bits, registers, echo, identity };

AnswerKind kind_of(std::uint8_t function) {
  switch (function) {
    case read_coils:
    case read_discrete_inputs:
      return AnswerKind::bits;
    case read_holding_registers:
    case read_input_registers:
    case write_and_read_registers:
      return AnswerKind::registers;
    case write_single_coil:
    case write_single_register:
    case write_coils:
    case write_holding_registers:
    case mask_write_register:
      return AnswerKind::echo;
    default:
      return AnswerKind::identity;
  }
}

// Bytes behind the count of them.
std::size_t value_bytes(const RtuQuestion& question) {
  const std::size_t count = question.range.count;
  return kind_of(question.function) == AnswerKind::bits ? (count + 7) / 8 : 2 * count;
}

std::uint16_t word(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] << 8 | bytes[at + 1]);
}

}  // namespace

RtuQuestion question_of(std::span<const std::uint8_t> request) {
  constexpr std::size_t range_bytes = 5;
  RtuQuestion question{.function = request[0], .range = {}};
  if (request.size() < range_bytes || kind_of(request[0]) == AnswerKind::identity) return question;
  question.range = {.first = word(request, 1), .count = word(request, 3)};
  return question;
}

bool are_answered_alike(const RtuQuestion& a, const RtuQuestion& b) {
  if (a.function != b.function) return false;
  switch (kind_of(a.function)) {
    case AnswerKind::bits:
    case AnswerKind::registers:
      return value_bytes(a) == value_bytes(b);
    case AnswerKind::echo:
      return a.range.first == b.range.first && a.range.count == b.range.count;
    case AnswerKind::identity:
      return true;
  }
  return true;
}

bool answers(std::span<const std::uint8_t> pdu, const RtuQuestion& question) {
  if (pdu[0] != question.function) return false;
  switch (kind_of(question.function)) {
    case AnswerKind::bits:
    case AnswerKind::registers:
      return pdu.size() == answer_bytes(question) && pdu[1] == value_bytes(question);
    case AnswerKind::echo:
      return pdu.size() == answer_bytes(question) && word(pdu, 1) == question.range.first &&
             word(pdu, 3) == question.range.count;
    case AnswerKind::identity:
      return pdu.size() <= pdu_bytes_max;
  }
  return false;
}

std::size_t answer_bytes(const RtuQuestion& question) {
  constexpr std::size_t echo_bytes = 5;
  constexpr std::size_t mask_bytes = 2;
  switch (kind_of(question.function)) {
    case AnswerKind::bits:
    case AnswerKind::registers:
      return 2 + value_bytes(question);
    case AnswerKind::echo:
      return echo_bytes + (question.function == mask_write_register ? mask_bytes : 0);
    case AnswerKind::identity:
      return pdu_bytes_max;
  }
  return pdu_bytes_max;
}

}  // namespace etcm::port
