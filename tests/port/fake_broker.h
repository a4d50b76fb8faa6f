// A broker of MQTT 5 in the test's hand: bytes that it has got, packets that it sends.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <string_view>

#include "peer.h"

namespace etcm::port {

namespace mqtt {

inline void append_text(Bytes& bytes, std::string_view text) {
  append_u16(bytes, static_cast<std::uint16_t>(text.size()));
  bytes.insert(bytes.end(), text.begin(), text.end());
}

inline void append_length(Bytes& bytes, std::size_t length) {
  do {
    const auto low = static_cast<std::uint8_t>(length & 0x7f);
    length >>= 7;
    bytes.push_back(static_cast<std::uint8_t>(low | (length > 0 ? 0x80 : 0)));
  } while (length > 0);
}

inline Bytes packet(std::uint8_t head, const Bytes& body) {
  Bytes bytes{head};
  append_length(bytes, body.size());
  bytes.insert(bytes.end(), body.begin(), body.end());
  return bytes;
}

// Without properties, or with these.
inline Bytes connack(std::uint8_t reason = 0, const Bytes& properties = {}) {
  Bytes body{0, reason};
  append_length(body, properties.size());
  body.insert(body.end(), properties.begin(), properties.end());
  return packet(0x20, body);
}
inline Bytes puback(std::uint16_t number, std::uint8_t reason = 0) {
  Bytes body;
  append_u16(body, number);
  if (reason != 0) body.insert(body.end(), {reason, 0});
  return packet(0x40, body);
}
inline Bytes suback(std::uint16_t number, std::uint8_t reason = 1) {
  Bytes body;
  append_u16(body, number);
  body.insert(body.end(), {0, reason});
  return packet(0x90, body);
}
// QoS 1.
inline Bytes publish(std::uint16_t number, std::string_view topic, std::string_view payload,
                     bool retained = false) {
  Bytes body;
  append_text(body, topic);
  append_u16(body, number);
  body.push_back(0);
  body.insert(body.end(), payload.begin(), payload.end());
  return packet(static_cast<std::uint8_t>(0x32 | (retained ? 1 : 0)), body);
}
inline Bytes disconnect(std::uint8_t reason) { return packet(0xe0, {reason}); }

}  // namespace mqtt

// A packet that a client has sent.
struct ClientPacket {
  std::uint8_t head = 0;
  Bytes body;

  std::uint8_t kind() const { return head & 0xf0; }
  std::uint16_t u16(std::size_t at) const {
    return static_cast<std::uint16_t>(body.at(at) << 8 | body.at(at + 1));
  }
  std::string text(std::size_t at) const {
    const auto begin = body.begin() + static_cast<std::ptrdiff_t>(at) + 2;
    return std::string(begin, begin + u16(at));
  }
  // Of a PUBLISH with QoS 1 and without properties, as all of ours are.
  std::string topic() const { return text(0); }
  std::uint16_t number() const { return kind() == 0x30 ? u16(2u + u16(0)) : u16(0); }
  std::string payload() const {
    const auto at = static_cast<std::ptrdiff_t>(2u + u16(0) + 3u);
    return std::string(body.begin() + at, body.end());
  }
  // Of a SUBSCRIBE.
  std::string filter() const { return text(3); }
};

class FakeBroker {
 public:
  std::uint16_t port() const { return bound_address(listener_.get()).port; }

  // Whether somebody is connected now; takes the next one, if nobody is.
  bool has_client() {
    if (!client_.is_open()) client_ = accept_tcp(listener_.get());
    return client_.is_open();
  }
  void hang_up() {
    client_.close();
    bytes_.clear();
  }
  bool is_left() const { return client_.is_open() && is_closed(client_.get()); }

  void send(const Bytes& bytes) {
    ASSERT_TRUE(client_.is_open());
    send_bytes(client_.get(), bytes);
  }
  // As much as fits; returns what was sent.
  std::size_t send_some(std::span<const std::uint8_t> bytes) {
    const ssize_t count =
        ::send(client_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    return count > 0 ? static_cast<std::size_t>(count) : 0;
  }

  // The next whole packet; false where none is there yet.
  bool take(ClientPacket& packet) {
    if (!has_client()) return false;
    receive_available(client_.get(), bytes_);
    std::size_t length = 0;
    std::size_t at = 1;
    for (unsigned shift = 0;; shift += 7) {
      if (at >= bytes_.size()) return false;
      length |= static_cast<std::size_t>(bytes_[at] & 0x7f) << shift;
      if ((bytes_[at++] & 0x80) == 0) break;
    }
    if (bytes_.size() < at + length) return false;
    const auto body = bytes_.begin() + static_cast<std::ptrdiff_t>(at);
    packet.head = bytes_[0];
    packet.body.assign(body, body + static_cast<std::ptrdiff_t>(length));
    bytes_.erase(bytes_.begin(), body + static_cast<std::ptrdiff_t>(length));
    return true;
  }

 private:
  FileDescriptor listener_ = listen_tcp({.host = loopback_ipv4, .port = 0});
  FileDescriptor client_;
  Bytes bytes_;
};

}  // namespace etcm::port
