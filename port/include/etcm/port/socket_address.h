// Where to reach somebody over TCP.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace etcm::port {

// An IPv4 address and port.
struct SocketAddress {
  std::uint32_t host = 0;  // 127.0.0.1 is 0x7f000001
  std::uint16_t port = 0;
};

// Reads "127.0.0.1:502"; nothing where that is no numeric address with a port.
std::optional<SocketAddress> parse_socket_address(std::string_view text);
std::string to_string(const SocketAddress& address);

}  // namespace etcm::port
