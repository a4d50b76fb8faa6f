// The address of a peer over TCP, IPv4 or IPv6.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace etcm::port {

// Of a host. An IPv4 address is held as the IPv6 address that stands for it (RFC 4291, 2.5.5.2), so
// a client is the same whichever kind of socket it comes to.
struct HostAddress {
  std::array<std::uint8_t, 16> bytes{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff, 0, 0, 0, 0};
  std::uint32_t zone = 0;  // number of the interface behind which a link-local address is

  constexpr HostAddress() = default;
  // 127.0.0.1 is 0x7f000001.
  constexpr HostAddress(std::uint32_t ipv4) {
    for (std::size_t i = 0; i < 4; ++i) {
      bytes[12 + i] = static_cast<std::uint8_t>(ipv4 >> (24 - 8 * i));
    }
  }
  explicit constexpr HostAddress(const std::array<std::uint8_t, 16>& ipv6, std::uint32_t in_zone)
      : bytes(ipv6), zone(in_zone) {}

  constexpr bool is_ipv4() const {
    for (std::size_t i = 0; i < 12; ++i) {
      if (bytes[i] != (i < 10 ? 0 : 0xff)) return false;
    }
    return true;
  }
  friend constexpr bool operator==(const HostAddress&, const HostAddress&) = default;
};
// Who listens there listens at all addresses of the machine; at any_ipv6 also at those of IPv4.
inline constexpr HostAddress any_ipv4{};
inline constexpr HostAddress any_ipv6{std::array<std::uint8_t, 16>{}, 0};
inline constexpr HostAddress loopback_ipv4{0x7f000001};
inline constexpr HostAddress loopback_ipv6{
    std::array<std::uint8_t, 16>{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1}, 0};

struct SocketAddress {
  HostAddress host;
  std::uint16_t port = 0;
  friend constexpr bool operator==(const SocketAddress&, const SocketAddress&) = default;
};

// Whether only one can listen at both. Of port 0 each is another.
bool is_one_place(const SocketAddress& a, const SocketAddress& b);

// Reads "127.0.0.1" or "2001:db8::1"; nothing for what is neither.
std::optional<HostAddress> parse_host_address(std::string_view text);
// Reads "127.0.0.1:502" or "[2001:db8::1]:502"; nothing where that is no address with a port.
std::optional<SocketAddress> parse_socket_address(std::string_view text);
std::string to_string(const SocketAddress& address);
// The host alone, as in "127.0.0.1" or "fe80::1%eth0".
std::string host_text(const HostAddress& host);

// The addresses that agree with `host` in their first bits: in `prefix` of them, counted as a
// person does, up to 32 of an IPv4 address and up to 128 of any other.
struct Network {
  HostAddress host;
  std::uint8_t prefix = 0;

  constexpr bool contains(const HostAddress& address) const {
    unsigned bits = prefix + (host.is_ipv4() ? 96u : 0u);
    for (std::size_t i = 0; bits > 0; ++i) {
      const unsigned here = bits < 8 ? bits : 8;
      if ((address.bytes[i] ^ host.bytes[i]) >> (8 - here) != 0) return false;
      bits -= here;
    }
    return true;
  }
  friend constexpr bool operator==(const Network&, const Network&) = default;
};
// "::/0", which contains all of IPv4 too.
inline constexpr Network everybody{.host = any_ipv6, .prefix = 0};
inline constexpr Network this_machine{.host = 0x7f000000, .prefix = 8};

// Whether any of the networks contains the address.
bool any_contains(std::span<const Network> networks, const HostAddress& address);

// Reads "10.0.0.0/8", "2001:db8::/32", or one address; nothing for what is none of these.
std::optional<Network> parse_network(std::string_view text);
std::string to_string(const Network& network);

}  // namespace etcm::port
