#include "master.h"

#include <modbus/modbus.h>

#include <array>

#include "modbus/frame.h"
#include "modbus/identity.h"

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
  std::uint8_t exception = 0;
  if (port::parse_read_answer(reply.pdu, function, registers, exception) !=
      port::ReadAnswer::registers) {
    return ErrorDetail{.kind = ErrorDetail::Kind::garbled};
  }
  return std::nullopt;
}

std::optional<ErrorDetail> Master::write(std::uint8_t unit, std::uint16_t first,
                                         std::span<const std::uint16_t> registers) {
  std::array<std::uint8_t, port::pdu_bytes_max> request;
  const std::size_t size = port::write_write_request(request, first, registers);
  const Reply reply = ask(unit, std::span(request).first(size));
  if (const auto error_detail = trouble_of(reply)) return error_detail;
  const port::RegisterRange range{.first = first,
                                  .count = static_cast<std::uint16_t>(registers.size())};
  std::uint8_t exception = 0;
  if (port::parse_write_answer(reply.pdu, range, exception) != port::WriteAnswer::written) {
    return ErrorDetail{.kind = ErrorDetail::Kind::garbled};
  }
  return std::nullopt;
}

void Master::broadcast(std::uint16_t first, std::span<const std::uint16_t> registers) {
  std::array<std::uint8_t, port::pdu_bytes_max> request;
  const std::size_t size = port::write_write_request(request, first, registers);
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
