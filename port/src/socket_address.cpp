#include "etcm/port/socket_address.h"

#include <arpa/inet.h>

#include <algorithm>
#include <charconv>
#include <system_error>

namespace etcm::port {

namespace {

std::optional<std::uint32_t> parse_host(std::string_view text) {
  in_addr native{};
  if (::inet_pton(AF_INET, std::string(text).c_str(), &native) != 1) return std::nullopt;
  return ntohl(native.s_addr);
}

template <class Number>
bool parse_whole(std::string_view text, Number& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

}  // namespace

std::optional<SocketAddress> parse_socket_address(std::string_view text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos) return std::nullopt;
  const auto host = parse_host(text.substr(0, colon));
  SocketAddress address;
  if (!host || !parse_whole(text.substr(colon + 1), address.port)) return std::nullopt;
  address.host = *host;
  return address;
}

std::string host_text(std::uint32_t host) {
  const in_addr native{htonl(host)};
  char text[INET_ADDRSTRLEN];
  ::inet_ntop(AF_INET, &native, text, sizeof text);
  return text;
}

std::string to_string(const SocketAddress& address) {
  return host_text(address.host) + ":" + std::to_string(address.port);
}

bool any_contains(std::span<const Network> networks, std::uint32_t address) {
  return std::any_of(networks.begin(), networks.end(),
                     [&](const Network& network) { return network.contains(address); });
}

std::optional<Network> parse_network(std::string_view text) {
  const std::size_t slash = text.find('/');
  Network network{.host = 0, .prefix = 32};
  if (slash != std::string_view::npos && !parse_whole(text.substr(slash + 1), network.prefix)) {
    return std::nullopt;
  }
  const auto host = parse_host(text.substr(0, slash));
  if (!host || network.prefix > 32) return std::nullopt;
  network.host = *host;
  return network;
}

std::string to_string(const Network& network) {
  return host_text(network.host) + "/" + std::to_string(network.prefix);
}

}  // namespace etcm::port
