#include "etcm/port/endpoint.h"

#include <algorithm>
#include <charconv>
#include <system_error>

namespace etcm::port {

namespace {

constexpr std::size_t name_bytes_max = 253;
constexpr std::size_t label_bytes_max = 63;
constexpr std::size_t zone_bytes_max = 15;

constexpr bool is_digit(char c) { return '0' <= c && c <= '9'; }
constexpr bool is_name_character(char c) {
  return is_digit(c) || ('a' <= c && c <= 'z') || c == '-' || c == '_';
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) {
    if ('A' <= c && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return lower;
}

bool is_label(std::string_view label) {
  return !label.empty() && label.size() <= label_bytes_max && label.front() != '-' &&
         label.back() != '-' && std::all_of(label.begin(), label.end(), is_name_character);
}

// A name as in RFC 1123, with the underscores that are in use. The resolver takes "10.0.5" for
// 10.0.0.5 and "0x7f.1" for 127.0.0.1, and would ask whoever is there: what ends in a number is an
// address or nothing.
bool is_name(std::string_view host) {
  if (host.ends_with('.')) host.remove_suffix(1);
  if (host.empty() || host.size() > name_bytes_max) return false;
  std::string_view label;
  for (std::size_t begin = 0; begin <= host.size(); begin += label.size() + 1) {
    label = host.substr(begin, host.find('.', begin) - begin);
    if (!is_label(label)) return false;
  }
  const bool is_hex = label.starts_with("0x") &&
                      label.find_first_not_of("0123456789abcdef", 2) == std::string_view::npos;
  return !is_hex && !std::all_of(label.begin(), label.end(), is_digit);
}

std::optional<std::string> read_ipv6(std::string_view text) {
  const std::size_t percent = text.find('%');
  const auto address = parse_host_address(text.substr(0, percent));
  if (!address || text.find(':') == std::string_view::npos) return std::nullopt;
  if (percent == std::string_view::npos) return host_text(*address);
  const std::string_view zone = text.substr(percent + 1);
  const bool is_zone = !zone.empty() && zone.size() <= zone_bytes_max &&
                       std::all_of(zone.begin(), zone.end(), [](char c) {
                         return '!' <= c && c <= '~' && c != '/' && c != '%' && c != ']';
                       });
  if (!is_zone || address->is_ipv4()) return std::nullopt;
  return host_text(*address) + "%" + std::string(zone);
}

std::optional<std::string> read_name_or_ipv4(std::string_view text) {
  if (text.find(':') != std::string_view::npos) return std::nullopt;
  if (const auto address = parse_host_address(text)) return host_text(*address);
  std::string name = lower_case(text);
  if (!is_name(name)) return std::nullopt;
  return name;
}

std::optional<std::uint16_t> read_port(std::string_view text) {
  std::uint16_t port = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return port;
}

}  // namespace

std::optional<Endpoint> parse_endpoint(std::string_view text,
                                       std::optional<std::uint16_t> standard_port) {
  std::optional<std::string> host;
  std::string_view behind;  // ":502", or nothing
  if (text.starts_with('[')) {
    const std::size_t bracket = text.find(']');
    if (bracket == std::string_view::npos) return std::nullopt;
    host = read_ipv6(text.substr(1, bracket - 1));
    behind = text.substr(bracket + 1);
  } else if (standard_port && std::count(text.begin(), text.end(), ':') > 1) {
    host = read_ipv6(text);
  } else {
    const std::size_t colon = std::min(text.rfind(':'), text.size());
    host = read_name_or_ipv4(text.substr(0, colon));
    behind = text.substr(colon);
  }
  const auto port = behind.empty()            ? standard_port
                    : behind.starts_with(':') ? read_port(behind.substr(1))
                                              : std::nullopt;
  if (!host || !port) return std::nullopt;
  return Endpoint{.host = *std::move(host), .port = *port};
}

std::string to_string(const Endpoint& end) {
  const bool is_ipv6 = end.host.find(':') != std::string::npos;
  return (is_ipv6 ? "[" + end.host + "]" : end.host) + ":" + std::to_string(end.port);
}

Endpoint endpoint_of(const SocketAddress& address) {
  return {.host = host_text(address.host), .port = address.port};
}

std::optional<HostAddress> address_of(const Endpoint& end) { return parse_host_address(end.host); }

bool has_name(const Endpoint& end) {
  return end.host.find(':') == std::string::npos && !address_of(end);
}

}  // namespace etcm::port
