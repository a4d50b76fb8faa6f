#include "etcm/port/socket_address.h"

#include <arpa/inet.h>
#include <net/if.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <system_error>

namespace etcm::port {

namespace {

constexpr std::uint8_t bits_of_ipv4 = 32;
constexpr std::uint8_t bits_of_ipv6 = 128;

std::optional<HostAddress> parse_ipv4(const std::string& text) {
  in_addr native{};
  if (::inet_pton(AF_INET, text.c_str(), &native) != 1) return std::nullopt;
  return HostAddress{ntohl(native.s_addr)};
}

std::optional<HostAddress> parse_ipv6(const std::string& text) {
  std::array<std::uint8_t, 16> bytes{};
  if (::inet_pton(AF_INET6, text.c_str(), bytes.data()) != 1) return std::nullopt;
  return HostAddress{bytes, 0};
}

template <class Number>
bool parse_whole(std::string_view text, Number& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

}  // namespace

bool is_one_place(const SocketAddress& a, const SocketAddress& b) {
  const auto contains = [](const HostAddress& any, const HostAddress& host) {
    return any == any_ipv6 || (any == any_ipv4 && host.is_ipv4());
  };
  return a.port != 0 && a.port == b.port &&
         (a.host == b.host || contains(a.host, b.host) || contains(b.host, a.host));
}

std::optional<HostAddress> parse_host_address(std::string_view text) {
  // The system reads up to a zero byte.
  const std::string whole(text);
  if (whole.size() != std::strlen(whole.c_str())) return std::nullopt;
  const auto ipv4 = parse_ipv4(whole);
  return ipv4 ? ipv4 : parse_ipv6(whole);
}

std::optional<SocketAddress> parse_socket_address(std::string_view text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos) return std::nullopt;
  std::string_view host = text.substr(0, colon);
  const bool is_bracketed = host.starts_with('[') && host.ends_with(']');
  if (is_bracketed) host = host.substr(1, host.size() - 2);
  const bool has_colons = host.find(':') != std::string_view::npos;
  const auto found = parse_host_address(host);
  SocketAddress address;
  if (!found || has_colons != is_bracketed || !parse_whole(text.substr(colon + 1), address.port)) {
    return std::nullopt;
  }
  address.host = *found;
  return address;
}

std::string host_text(const HostAddress& host) {
  char text[INET6_ADDRSTRLEN];
  if (host.is_ipv4()) {
    ::inet_ntop(AF_INET, host.bytes.data() + 12, text, sizeof text);
    return text;
  }
  ::inet_ntop(AF_INET6, host.bytes.data(), text, sizeof text);
  if (host.zone == 0) return text;
  char interface[IF_NAMESIZE];
  return std::string(text) + "%" +
         (::if_indextoname(host.zone, interface) != nullptr ? interface : std::to_string(host.zone));
}

std::string to_string(const SocketAddress& address) {
  const std::string host = host_text(address.host);
  return (address.host.is_ipv4() ? host : "[" + host + "]") + ":" + std::to_string(address.port);
}

bool any_contains(std::span<const Network> networks, const HostAddress& address) {
  return std::any_of(networks.begin(), networks.end(),
                     [&](const Network& network) { return network.contains(address); });
}

std::optional<Network> parse_network(std::string_view text) {
  const std::size_t slash = text.find('/');
  const auto host = parse_host_address(text.substr(0, slash));
  if (!host) return std::nullopt;
  const std::uint8_t longest = host->is_ipv4() ? bits_of_ipv4 : bits_of_ipv6;
  Network network{.host = *host, .prefix = longest};
  if (slash != std::string_view::npos && !parse_whole(text.substr(slash + 1), network.prefix)) {
    return std::nullopt;
  }
  if (network.prefix > longest) return std::nullopt;
  return network;
}

std::string to_string(const Network& network) {
  return host_text(network.host) + "/" + std::to_string(network.prefix);
}

}  // namespace etcm::port
