#include "command.h"

#include <charconv>

#include "modbus/frame.h"
#include "modbus/question.h"

namespace etcm::bus {

namespace {

using namespace std::chrono_literals;

constexpr port::Duration timeout_least = 10ms;
constexpr port::Duration timeout_most = 10s;

template <class Number>
std::optional<Number> whole_number(std::string_view text, int base = 10) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// "converter", "192.168.1.5", "[2001:db8::1]", each with or without ":502".
port::Endpoint endpoint(const std::string& device, std::uint16_t tcp_port) {
  const auto end = port::parse_endpoint(device, tcp_port);
  if (end) return *end;
  throw UsageError(device +
                   ": no host with a port; write a name, an IPv4 address with four numbers of at "
                   "most 255, as in "
                   "192.168.1.5:502, or an IPv6 address, as in [2001:db8::1]:502");
}

}  // namespace

void BusOptions::add_to(CLI::App& command, Digits digits) {
  command.add_option("device", device_, "path of a serial port, or host or host:port; [IPV6]:port")
      ->required();
  command
      .add_option("-m,--mode", mode_, "rtu or tcp; without it a device with a / is a serial port")
      ->check(CLI::IsMember({"rtu", "tcp"}));
  command.add_option("-a,--units", units_, "units: 1, 1-10, 1,5,9")->capture_default_str();
  command.add_option("-o,--timeout", timeout_s_, "seconds that a unit may take to answer")
      ->capture_default_str();
  command.add_option("-p,--port", tcp_port_, "TCP port")->capture_default_str();
  command.add_option("-b,--baud", line_.baud, "speed of the serial line")->capture_default_str();
  command.add_option("-P,--parity", parity_, "none, even or odd")
      ->check(CLI::IsMember({"none", "even", "odd"}))
      ->capture_default_str();
  command.add_option("-s,--stop-bits", line_.stop_bits, "1 or 2")
      ->check(CLI::Range(1, 2))
      ->capture_default_str();
  command.add_flag("-R,--rts", has_rts_, "the driver switches an RS-485 transceiver by RTS");
  // What is so anyway: lines that were written for mbpoll shall do.
  command.add_flag("-q,-B", is_as_always_, "as mbpoll has them: no head, high words first");
  if (digits == Digits::are_options) {
    command.add_flag("-1", is_once_, "once; only poll would go on");
    command.add_flag("-0", is_as_always_, "as mbpoll has it: registers count from 0");
  }
  command.add_flag("-v,--verbose", is_verbose_, "show each frame: sent in [], heard in <>");
}

bool BusOptions::is_serial() const {
  return mode_.empty() ? device_.find('/') != std::string::npos : mode_ == "rtu";
}

std::vector<std::uint8_t> BusOptions::units(int least) const {
  const auto units = parse_unit_list(units_, least);
  if (!units) throw UsageError("-a " + units_ + ": no units; write 1, 1-10 or 1,5,9, up to 247");
  return *units;
}

port::Duration BusOptions::timeout() const {
  double seconds = 0;
  const char* const end = timeout_s_.data() + timeout_s_.size();
  const auto parsed = std::from_chars(timeout_s_.data(), end, seconds);
  const bool is_number = parsed.ec == std::errc{} && parsed.ptr == end && seconds < 1000;
  const auto timeout =
      is_number ? std::chrono::duration_cast<port::Duration>(std::chrono::duration<double>(seconds))
                : port::Duration{};
  if (timeout < timeout_least || timeout > timeout_most) {
    throw UsageError("-o " + timeout_s_ + ": no timeout; give seconds, 0.01 to 10");
  }
  return timeout;
}

std::unique_ptr<Link> BusOptions::open() const {
  const Frames frames = is_verbose_ ? Frames::shown : Frames::hidden;
  if (!is_serial()) return open_tcp_link(endpoint(device_, tcp_port_), frames);
  port::SerialLine line = line_;
  if (!port::is_baud(line.baud)) {
    throw UsageError("-b " + std::to_string(line.baud) +
                     ": no speed; give 9600, 19200, 115200, or another from " +
                     std::to_string(port::baud_least) + " to " + std::to_string(port::baud_most));
  }
  line.path = device_;
  line.parity = parity_ == "none"   ? port::Parity::none
                : parity_ == "even" ? port::Parity::even
                                    : port::Parity::odd;
  if (has_rts_) line.rs485.mode = port::Rs485Mode::on;
  return open_serial_link(line, frames);
}

void TypeOptions::add_to(CLI::App& command, std::string table) {
  table_ = std::move(table);
  command
      .add_option("-t,--type", table_,
                  "0 coils, 1 discrete inputs; 3 input or 4 holding registers, and what stands in "
                  "them: 4:u16, i16, u32, i32, hex, float")
      ->capture_default_str();
  command.add_option("-w,--word-order", order_, "ABCD, BADC, CDAB or DCBA, A the highest byte")
      ->capture_default_str();
}

std::uint8_t TypeOptions::function() const {
  if (table_ == "0") return port::read_coils;
  if (table_ == "1") return port::read_discrete_inputs;
  if (table_ == "3" || table_.starts_with("3:")) return port::read_input_registers;
  if (table_ == "4" || table_.starts_with("4:")) return port::read_holding_registers;
  throw UsageError("-t " + table_ +
                   ": no table; give 0 (coils), 1 (discrete inputs), 3 (input registers) or 4 "
                   "(holding registers)");
}

bool TypeOptions::are_bits() const { return table_ == "0" || table_ == "1"; }

ValueType TypeOptions::type() const {
  const std::size_t colon = table_.find(':');
  const auto kind = parse_value_kind(
      colon == std::string::npos ? "u16" : std::string_view(table_).substr(colon + 1));
  if (!kind) {
    throw UsageError("-t " + table_ +
                     ": no kind of values; write 4:u16, i16, u32, i32, hex, float");
  }
  const auto order = parse_word_order(order_);
  if (!order) throw UsageError("-w " + order_ + ": give ABCD, BADC, CDAB or DCBA");
  return {.kind = *kind, .order = *order};
}

void add_first_option(CLI::App& command, std::string& text) {
  text = "0";
  command
      .add_option("-r,--first", text,
                  "first register, counted from 0 as in the tables of most makers")
      ->capture_default_str();
}

std::uint16_t parse_first(const std::string& text) {
  const bool is_hex = text.starts_with("0x");
  const auto first =
      whole_number<std::uint16_t>(std::string_view(text).substr(is_hex ? 2 : 0), is_hex ? 16 : 10);
  if (!first) throw UsageError("-r " + text + ": no register; give 0 to 65535");
  return *first;
}

std::string milliseconds_text(port::Duration duration) {
  const auto tenths = duration / std::chrono::microseconds(100);
  return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " ms";
}

}  // namespace etcm::bus
