#include "mqtt/packet_guard.h"

#include <algorithm>

namespace etcm::port {

namespace {

// First bytes of packets (MQTT 5, 2.1.2); of PUBLISH the low four bits vary.
constexpr std::uint8_t connack = 0x20;
constexpr std::uint8_t publish = 0x30;
constexpr std::uint8_t puback = 0x40;
constexpr std::uint8_t suback = 0x90;
constexpr std::uint8_t pingresp = 0xd0;
constexpr std::uint8_t disconnect = 0xe0;
constexpr std::uint8_t kind_mask = 0xf0;
constexpr std::uint8_t qos_1 = 0x02;
constexpr std::uint8_t qos_2 = 0x04;  // and with the bit below it, what is no QoS

constexpr unsigned length_bytes_max = 4;
// Properties of a greeting or a farewell: addresses of other brokers, reasons in words.
constexpr std::uint32_t greeting_max = 8192;
// A number, a reason, and no properties: it was asked to send none.
constexpr std::uint32_t answer_max = 4;

// Numbers of properties by what their values are made of (MQTT 5, 2.2.2.2).
constexpr std::uint8_t byte_properties[] = {0x01, 0x17, 0x19, 0x24, 0x25, 0x28, 0x29, 0x2a};
constexpr std::uint8_t two_byte_properties[] = {0x13, 0x21, 0x22, 0x23};
constexpr std::uint8_t four_byte_properties[] = {0x02, 0x11, 0x18, 0x27};
constexpr std::uint8_t text_properties[] = {0x03, 0x08, 0x09, 0x12, 0x15, 0x16, 0x1a, 0x1c, 0x1f};
constexpr std::uint8_t varint_property = 0x0b;
constexpr std::uint8_t pair_property = 0x26;

constexpr const char* unsound = "it sends a packet that is not sound";

}  // namespace

bool PacketGuard::pass(std::span<const std::uint8_t> bytes) {
  std::size_t at = 0;
  while (at < bytes.size()) {
    if (part_ == Part::skip || part_ == Part::rest) {
      at += take_many(bytes.size() - at);
      if (part_ == Part::skip && skip_ == 0 && !advance()) return false;
      if (part_ == Part::rest && left_ == 0) part_ = Part::head;
    } else if (!take(bytes[at++])) {
      return false;
    }
  }
  return true;
}

std::size_t PacketGuard::take_many(std::size_t available) {
  const std::uint32_t wanted = part_ == Part::rest ? left_ : skip_;
  const auto here = static_cast<std::uint32_t>(std::min<std::size_t>(available, wanted));
  left_ -= here;
  if (part_ == Part::skip) skip_ -= here;
  return here;
}

bool PacketGuard::take(std::uint8_t byte) {
  if (part_ == Part::head) return take_head(byte);
  if (part_ == Part::length) return take_length(byte);
  if (!count(1)) return false;
  switch (part_) {
    case Part::text_length:
      number_ = number_ << 8 | byte;
      if (++number_bytes_ < 2) return true;
      --texts_;
      return start_skip(number_);
    case Part::varint:
    case Part::properties:
      number_ |= std::uint32_t{byte & 0x7fu} << (7 * number_bytes_++);
      if ((byte & 0x80u) != 0) return number_bytes_ < length_bytes_max || refuse(unsound);
      if (part_ == Part::properties) {
        has_properties_ = true;
        properties_left_ = number_;
        if (properties_left_ > left_) return refuse(unsound);
      }
      return advance();
    case Part::property:
      return take_property(byte);
    case Part::zero:
      return byte == 0 ? advance() : refuse(unsound);
    default:
      return refuse(unsound);
  }
}

// So many bytes are read that must be there.
bool PacketGuard::count(std::uint32_t bytes) {
  if (bytes > left_ || (has_properties_ && bytes > properties_left_)) return refuse(unsound);
  left_ -= bytes;
  if (has_properties_) properties_left_ -= bytes;
  return true;
}

// They are there, and are read as they come.
bool PacketGuard::start_skip(std::uint32_t bytes) {
  if (!count(bytes)) return false;
  left_ += bytes;
  skip_ = bytes;
  if (bytes == 0) return advance();
  part_ = Part::skip;
  return true;
}

bool PacketGuard::take_head(std::uint8_t head) {
  const bool is_publish = (head & kind_mask) == publish && (head & qos_2) == 0;
  const bool is_answer = head == puback || head == suback || head == pingresp || head == disconnect;
  if (is_greeted_ ? !is_publish && !is_answer : head != connack) {
    return refuse(is_greeted_ ? "it sends what a client has not asked for"
                              : "what it sends first is no MQTT 5");
  }
  is_greeted_ = true;
  head_ = head;
  number_ = 0;
  number_bytes_ = 0;
  part_ = Part::length;
  ++begun_;
  return true;
}

bool PacketGuard::take_length(std::uint8_t byte) {
  number_ |= std::uint32_t{byte & 0x7fu} << (7 * number_bytes_++);
  if ((byte & 0x80u) != 0) {
    return number_bytes_ < length_bytes_max || refuse("it sends a packet without a length");
  }
  left_ = number_;
  step_ = 0;
  texts_ = 0;
  has_properties_ = false;
  return check_length() && advance();
}

bool PacketGuard::check_length() {
  const bool is_message = (head_ & kind_mask) == publish;
  const std::uint32_t most = is_message                                ? packet_bytes_max_
                             : head_ == connack || head_ == disconnect ? greeting_max
                             : head_ == pingresp                       ? 0
                                                                       : answer_max;
  const std::uint32_t whole = is_message ? left_ + 1 + number_bytes_ : left_;
  return whole <= most || refuse("it sends a packet that is longer than was agreed on");
}

// What comes next: what is left of a property, another one, or a part of the packet.
bool PacketGuard::advance() {
  number_ = 0;
  number_bytes_ = 0;
  if (texts_ > 0) {
    part_ = Part::text_length;
  } else if (has_properties_ && properties_left_ > 0) {
    part_ = Part::property;
  } else {
    has_properties_ = false;
    part_ = next_of_packet();
    if (part_ == Part::skip) return start_skip(skip_);
    if ((part_ == Part::rest || part_ == Part::end) && left_ == 0) part_ = Part::head;
  }
  const bool has_bytes = part_ == Part::head || (part_ != Part::end && left_ > 0);
  return has_bytes || refuse(unsound);
}

PacketGuard::Part PacketGuard::next_of_packet() {
  const unsigned step = step_++;
  const auto skipped = [&](std::uint32_t bytes) {
    skip_ = bytes;
    return Part::skip;
  };
  switch (head_) {
    case connack:
      if (step > 0 && left_ == 0) return Part::end;  // of a broker that knows MQTT 3 alone
      return step == 0 ? skipped(2) : step == 1 ? Part::properties : Part::end;
    case disconnect:
      if (left_ == 0) return Part::end;
      return step == 0 ? skipped(1) : step == 1 ? Part::properties : Part::end;
    case puback:
      if (step == 0) return skipped(2);
      if (left_ == 0) return Part::end;
      return step == 1 ? skipped(1) : step == 2 ? Part::zero : Part::end;
    case suback:
      return step == 0 ? skipped(2) : step == 1 ? Part::zero : step == 2 ? skipped(1) : Part::end;
    case pingresp:
      return Part::end;
    default:
      if (step == 0) {
        texts_ = 1;
        return Part::text_length;
      }
      if (step == 1) return skipped((head_ & qos_1) != 0 ? 2 : 0);
      return step == 2 ? Part::properties : Part::rest;
  }
}

// By its number, what its value is made of.
bool PacketGuard::take_property(std::uint8_t number) {
  const auto is_of = [number](std::span<const std::uint8_t> numbers) {
    return std::find(numbers.begin(), numbers.end(), number) != numbers.end();
  };
  if (is_of(byte_properties)) return start_skip(1);
  if (is_of(two_byte_properties)) return start_skip(2);
  if (is_of(four_byte_properties)) return start_skip(4);
  texts_ = is_of(text_properties) ? 1 : number == pair_property ? 2 : 0;
  if (texts_ == 0 && number != varint_property) {
    return refuse("it sends a property that MQTT 5 does not have");
  }
  if (texts_ > 0) return advance();
  part_ = Part::varint;
  return left_ > 0 || refuse(unsound);
}

bool PacketGuard::refuse(const char* why) {
  why_ = why;
  return false;
}

}  // namespace etcm::port
