// Short texts that stand in settings, requests and commands: addresses, names, numbers, topics.
#include <array>
#include <string>

#include "etcm/port/endpoint.h"
#include "etcm/port/socket_address.h"
#include "etcm/port/utf8.h"
#include "firmware/config/names.h"
#include "firmware/fleet/fleet_topics.h"
#include "firmware/profile/fraction.h"
#include "fuzz_target.h"
#include "http/host_check.h"

namespace etcm::fuzz {
namespace {

void check_addresses(std::string_view text) {
  if (const auto end = port::parse_endpoint(text)) {
    require(port::parse_endpoint(port::to_string(*end)) == end, "an endpoint is another one");
    if (const auto address = port::address_of(*end)) {
      const port::SocketAddress place{.host = *address, .port = end->port};
      require(port::endpoint_of(place) == *end, "an address is another one");
    }
  }
  if (const auto address = port::parse_socket_address(text)) {
    require(port::parse_socket_address(port::to_string(*address)) == address,
            "an address is another one");
  }
  if (const auto network = port::parse_network(text)) {
    require(port::parse_network(port::to_string(*network)) == network, "a network is another one");
    require(network->contains(network->host), "a network is not in itself");
  }
}

void check_hosts(std::string_view text) {
  const std::array<std::string, 2> names{"gateway.example", "yard"};
  const port::RequestedHost host = port::check_host(text, names);
  require(!host.is_known || host.name.empty(), "a known host has a name");
  // It goes to whoever asked.
  for (const char c : host.name) require(c > ' ' && c < 0x7f && c != '"', "a name breaks a text");
  require(!port::unknown_host_text(host).empty(), "no reason");
}

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t size = port::utf8_character(text);
    if (size == 0) return false;
    text.remove_prefix(size);
  }
  return true;
}

void check_names(std::string_view text) {
  if (!is_utf8(text)) return;
  for (std::size_t most = 0; most < 8; ++most) {
    const std::string_view cut = port::cut_utf8(text, most);
    require(cut.size() <= most && is_utf8(cut), "a text is cut inside a character");
  }
  const std::string name = firmware::name_of_map(text);
  require(name.size() <= firmware::name_bytes_max, "a name is too long");
  require(name.empty() || firmware::is_name(name), "a name is none");
}

}  // namespace

void run(std::span<const std::uint8_t> bytes) {
  const std::string text(text_of(bytes));
  check_addresses(text);
  check_hosts(text);
  check_names(text);
  static_cast<void>(firmware::parse_topic(text, "yard"));
  if (const auto fraction = firmware::Fraction::parse(text)) {
    require(fraction->denominator > 0, "a fraction without a denominator");
    static_cast<void>(firmware::multiply(*fraction, *fraction));
    static_cast<void>(firmware::scaled(12'345, *fraction));
  }
}

}  // namespace etcm::fuzz
