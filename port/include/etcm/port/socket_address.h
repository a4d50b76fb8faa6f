// The address of a peer over TCP.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace etcm::port {

// An IPv4 address and port.
struct SocketAddress {
  std::uint32_t host = 0;  // 127.0.0.1 is 0x7f000001
  std::uint16_t port = 0;
  friend constexpr bool operator==(const SocketAddress&, const SocketAddress&) = default;
};

// Reads "127.0.0.1:502"; nothing where that is no numeric address with a port.
std::optional<SocketAddress> parse_socket_address(std::string_view text);
std::string to_string(const SocketAddress& address);
// The host alone, as in "127.0.0.1".
std::string host_text(std::uint32_t host);

// The IPv4 addresses that agree with `host` in their first `prefix` bits.
struct Network {
  std::uint32_t host = 0;
  std::uint8_t prefix = 0;

  constexpr bool contains(std::uint32_t address) const {
    return prefix == 0 || (address ^ host) >> (32 - prefix) == 0;
  }
  friend constexpr bool operator==(const Network&, const Network&) = default;
};
inline constexpr Network everybody{};
inline constexpr Network this_machine{.host = 0x7f000000, .prefix = 8};

// Whether any of the networks contains the address.
bool any_contains(std::span<const Network> networks, std::uint32_t address);

// Reads "10.0.0.0/8", or one address; nothing for what is neither.
std::optional<Network> parse_network(std::string_view text);
std::string to_string(const Network& network);

}  // namespace etcm::port
