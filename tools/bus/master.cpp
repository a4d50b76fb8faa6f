#include "master.h"

#include <modbus/modbus.h>

#include <algorithm>
#include <array>

#include "modbus/frame.h"
#include "modbus/identity.h"
#include "modbus/question.h"

namespace etcm::bus {

namespace {

constexpr std::uint8_t exception_bit = 0x80;
// Units carry out broadcasts; they are not ready for the next question at once.
constexpr port::Duration turnaround = std::chrono::milliseconds(200);

// What comes from a bus may be anything, and goes to a person's terminal.
std::string printable(std::string_view text) {
  std::string cleaned;
  for (const char letter : text) cleaned += letter >= ' ' && letter <= '~' ? letter : '?';
  return cleaned;
}

void put_word(std::span<std::uint8_t> pdu, std::size_t at, std::size_t word) {
  pdu[at] = static_cast<std::uint8_t>(word >> 8);
  pdu[at + 1] = static_cast<std::uint8_t>(word);
}

// As port::write_write_request() has it.
std::size_t write_coils_request(std::span<std::uint8_t> pdu, std::uint16_t first,
                                std::span<const std::uint16_t> coils) {
  constexpr std::size_t head = 6;
  put_word(pdu, 1, first);
  if (coils.size() == 1) {
    pdu[0] = port::write_single_coil;
    put_word(pdu, 3, coils[0] != 0 ? 0xff00 : 0);
    return head - 1;
  }
  const std::size_t bytes = (coils.size() + 7) / 8;
  pdu[0] = port::write_coils;
  put_word(pdu, 3, coils.size());
  pdu[5] = static_cast<std::uint8_t>(bytes);
  std::fill_n(pdu.begin() + head, bytes, std::uint8_t{0});
  for (std::size_t i = 0; i < coils.size(); ++i) {
    if (coils[i] != 0) pdu[head + i / 8] |= static_cast<std::uint8_t>(1u << i % 8);
  }
  return head + bytes;
}

std::size_t write_request(std::span<std::uint8_t> pdu, std::uint8_t table, std::uint16_t first,
                          std::span<const std::uint16_t> values) {
  return table == port::read_coils ? write_coils_request(pdu, first, values)
                                   : port::write_write_request(pdu, first, values);
}

bool reads_bits(std::uint8_t function) {
  return function == port::read_coils || function == port::read_discrete_inputs;
}

std::optional<ErrorDetail> trouble_of(const Reply& reply) {
  switch (reply.outcome) {
    case Outcome::silence:
      return ErrorDetail{.kind = ErrorDetail::Kind::silence};
    case Outcome::garbled:
      return ErrorDetail{.kind = ErrorDetail::Kind::garbled};
    case Outcome::answer:
      break;
  }
  if (reply.pdu.size() == 2 && (reply.pdu[0] & exception_bit) != 0) {
    return ErrorDetail{.kind = ErrorDetail::Kind::exception, .exception = reply.pdu[1]};
  }
  return std::nullopt;
}

}  // namespace

bool ErrorDetail::is_absence() const {
  return kind == Kind::silence ||
         (kind == Kind::exception && (exception == MODBUS_EXCEPTION_GATEWAY_PATH ||
                                      exception == MODBUS_EXCEPTION_GATEWAY_TARGET));
}

std::string cure_of(const ErrorDetail& error_detail) {
  if (error_detail.kind == ErrorDetail::Kind::silence) {
    return "; check the unit (-a), on a serial line also -b and -P, or wait longer (-o)";
  }
  if (error_detail.kind == ErrorDetail::Kind::exception &&
      error_detail.exception == MODBUS_EXCEPTION_ILLEGAL_DATA_ADDRESS) {
    return "; it has no such registers in this table: they count from 0 (-r), and -t is the table";
  }
  return "";
}

std::string to_string(const ErrorDetail& error_detail) {
  switch (error_detail.kind) {
    case ErrorDetail::Kind::silence:
      return "no answer";
    case ErrorDetail::Kind::garbled:
      return "garbled answer: noise, or two units with this address";
    case ErrorDetail::Kind::exception:
      break;
  }
  std::string code = "exception " + std::to_string(error_detail.exception);
  if (error_detail.exception == 0 || error_detail.exception >= MODBUS_EXCEPTION_MAX) return code;
  return code + ": " + modbus_strerror(MODBUS_ENOBASE + error_detail.exception);
}

std::string to_string(const Identification& who) {
  std::string text;
  for (const std::string* part : {&who.vendor, &who.product, &who.version, &who.server_id}) {
    if (!part->empty()) text += (text.empty() ? "" : " ") + *part;
  }
  return text;
}

Reply Master::ask(std::uint8_t unit, std::span<const std::uint8_t> request) {
  const Reply reply = link_.ask(unit, request, timeout_);
  took_ = reply.took;
  return reply;
}

bool Master::may_read(std::uint8_t unit, std::uint8_t function, port::RegisterRange range) const {
  std::array<std::uint8_t, port::pdu_bytes_max> request;
  const std::size_t size = port::write_read_request(request, function, range);
  return link_.may_ask(unit, std::span(request).first(size));
}

std::optional<ErrorDetail> Master::read(std::uint8_t unit, std::uint8_t function,
                                        std::uint16_t first, std::span<std::uint16_t> registers) {
  std::array<std::uint8_t, port::pdu_bytes_max> request;
  const std::size_t size = port::write_read_request(
      request, function, {.first = first, .count = static_cast<std::uint16_t>(registers.size())});
  const Reply reply = ask(unit, std::span(request).first(size));
  if (const auto error_detail = trouble_of(reply)) return error_detail;
  if (reads_bits(function)) {
    const port::RtuQuestion question = port::question_of(std::span(request).first(size));
    if (!port::answers(reply.pdu, question)) return ErrorDetail{.kind = ErrorDetail::Kind::garbled};
    for (std::size_t i = 0; i < registers.size(); ++i) {
      registers[i] = reply.pdu[2 + i / 8] >> i % 8 & 1u;
    }
    return std::nullopt;
  }
  std::uint8_t exception = 0;
  if (port::parse_read_answer(reply.pdu, function, registers, exception) !=
      port::ReadAnswer::registers) {
    return ErrorDetail{.kind = ErrorDetail::Kind::garbled};
  }
  return std::nullopt;
}

std::optional<ErrorDetail> Master::write(std::uint8_t unit, std::uint8_t table, std::uint16_t first,
                                         std::span<const std::uint16_t> values) {
  std::array<std::uint8_t, port::pdu_bytes_max> request;
  const std::size_t size = write_request(request, table, first, values);
  const Reply reply = ask(unit, std::span(request).first(size));
  if (const auto error_detail = trouble_of(reply)) return error_detail;
  if (!port::answers(reply.pdu, port::question_of(std::span(request).first(size)))) {
    return ErrorDetail{.kind = ErrorDetail::Kind::garbled};
  }
  return std::nullopt;
}

void Master::broadcast(std::uint8_t table, std::uint16_t first,
                       std::span<const std::uint16_t> values) {
  std::array<std::uint8_t, port::pdu_bytes_max> request;
  const std::size_t size = write_request(request, table, first, values);
  static_cast<void>(link_.ask(everybody, std::span(request).first(size), turnaround));
}

bool Master::identify_by_objects(std::uint8_t unit, Identification& who) {
  std::array<std::uint8_t, port::pdu_bytes_max> request;
  std::array<std::string*, 3> const texts{&who.vendor, &who.product, &who.version};
  std::uint8_t next = 0;
  while (next < texts.size()) {
    const std::size_t size = port::write_identification_request(request, next);
    const Reply reply = ask(unit, std::span(request).first(size));
    port::Identity found;
    const auto following =
        trouble_of(reply) ? std::nullopt : port::parse_identification_answer(reply.pdu, found);
    // A unit that never comes to an end is not asked for ever.
    if (!following || *following <= next) return next > 0;
    for (std::size_t i = 0; i < texts.size(); ++i) {
      if (!found.objects[i].empty()) *texts[i] = printable(found.objects[i]);
    }
    next = *following;
  }
  return true;
}

Identification Master::identify(std::uint8_t unit) {
  Identification who;
  if (identify_by_objects(unit, who)) return who;
  std::array<std::uint8_t, port::pdu_bytes_max> request;
  const std::size_t size = port::write_server_id_request(request);
  const Reply reply = ask(unit, std::span(request).first(size));
  if (trouble_of(reply)) return who;
  if (const auto data = port::parse_server_id_answer(reply.pdu)) {
    std::string_view text(reinterpret_cast<const char*>(data->data()), data->size());
    // An identifier of the maker's own length, whether it runs (0x00 or 0xff), and the text.
    const std::size_t runs = text.find_first_of(std::string_view("\x00\xff", 2));
    if (runs != std::string_view::npos) text.remove_prefix(runs + 1);
    who.server_id = printable(text);
  }
  return who;
}

}  // namespace etcm::bus
