#include "etcm/port/socket_address.h"

#include <arpa/inet.h>

#include <charconv>
#include <system_error>

namespace etcm::port {

std::optional<SocketAddress> parse_socket_address(std::string_view text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos) return std::nullopt;
  const std::string host(text.substr(0, colon));
  const std::string_view port = text.substr(colon + 1);
  in_addr native{};
  if (::inet_pton(AF_INET, host.c_str(), &native) != 1) return std::nullopt;
  SocketAddress address{.host = ntohl(native.s_addr), .port = 0};
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), address.port);
  if (error != std::errc{} || end != port.data() + port.size()) return std::nullopt;
  return address;
}

std::string to_string(const SocketAddress& address) {
  const in_addr native{htonl(address.host)};
  char text[INET_ADDRSTRLEN];
  ::inet_ntop(AF_INET, &native, text, sizeof text);
  return std::string(text) + ":" + std::to_string(address.port);
}

}  // namespace etcm::port
