// The other end of a connection, in the test's hand: plain blocking sockets, bytes written down.
#pragma once

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "etcm/port/log.h"
#include "posix/event_loop.h"
#include "posix/steady_clock.h"
#include "posix/tcp_socket.h"

namespace etcm::port {

using Bytes = std::vector<std::uint8_t>;

// How long a test waits for what must come.
inline constexpr Duration patience = std::chrono::seconds(20);

class KeptLog final : public Log {
 public:
  void write(Level, std::string_view line) override { lines.emplace_back(line); }
  std::vector<std::string> lines;
};

// Turns the loop until the condition holds.
inline testing::AssertionResult turn_until(EventLoop& loop,
                                           const std::function<bool()>& condition) {
  const SteadyClock clock;
  const Instant end = clock.now() + patience;
  while (!condition()) {
    if (clock.now() > end) return testing::AssertionFailure() << "it never came";
    loop.wait(std::chrono::milliseconds(5));
  }
  return testing::AssertionSuccess();
}

inline void send_bytes(int descriptor, const Bytes& bytes) {
  ASSERT_EQ(::send(descriptor, bytes.data(), bytes.size(), MSG_NOSIGNAL),
            static_cast<ssize_t>(bytes.size()));
}

// A client that connects from another address of this machine, 127.0.0.`host`. Blocking.
inline FileDescriptor connect_from(std::uint8_t host, const SocketAddress& server) {
  FileDescriptor socket(::socket(AF_INET, SOCK_STREAM, 0));
  const NativeAddress own = to_native({.host = 0x7f000000u + host, .port = 0});
  const NativeAddress there = to_native(server);
  EXPECT_EQ(::bind(socket.get(), own.get(), own.size), 0);
  EXPECT_EQ(::connect(socket.get(), there.get(), there.size), 0);
  return socket;
}

// What has arrived by now; never waits.
inline void receive_available(int descriptor, Bytes& bytes) {
  std::uint8_t chunk[4096];
  while (true) {
    const ssize_t count = ::recv(descriptor, chunk, sizeof chunk, MSG_DONTWAIT);
    if (count <= 0) return;
    bytes.insert(bytes.end(), chunk, chunk + count);
  }
}

// Whether the other side has closed the connection (and nothing is left to read).
inline bool is_closed(int descriptor) {
  std::uint8_t byte;
  return ::recv(descriptor, &byte, 1, MSG_DONTWAIT | MSG_PEEK) == 0;
}

inline void append_u16(Bytes& bytes, std::uint16_t value) {
  bytes.push_back(static_cast<std::uint8_t>(value >> 8));
  bytes.push_back(static_cast<std::uint8_t>(value & 0xff));
}

inline Bytes frame_of(std::uint16_t transaction, std::uint8_t unit, const Bytes& pdu) {
  Bytes bytes;
  append_u16(bytes, transaction);
  append_u16(bytes, 0);
  append_u16(bytes, static_cast<std::uint16_t>(pdu.size() + 1));
  bytes.push_back(unit);
  bytes.insert(bytes.end(), pdu.begin(), pdu.end());
  return bytes;
}

inline Bytes read_request(std::uint16_t transaction, std::uint8_t unit, std::uint16_t first,
                          std::uint16_t count) {
  Bytes pdu{4};
  append_u16(pdu, first);
  append_u16(pdu, count);
  return frame_of(transaction, unit, pdu);
}

}  // namespace etcm::port
