// Where a TCP connection leads, as a person writes it: by address, or by a name that is looked up
// each time.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "etcm/port/socket_address.h"

namespace etcm::port {

struct Endpoint {
  // "192.0.2.5", "2001:db8::1", "fe80::1%eth0" or "plc.example"; in one spelling, so that the same
  // is equal. Whether there is such an interface, or such a name, shows when one connects.
  std::string host;
  std::uint16_t port = 0;
  friend bool operator==(const Endpoint&, const Endpoint&) = default;
};

// Reads "plc.example:502", "192.0.2.5:502", "[2001:db8::1]:502" or "[fe80::1%eth0]:502"; nothing
// for what is none of these. With a `standard_port` the port may be left out, and of an IPv6
// address then the brackets too.
std::optional<Endpoint> parse_endpoint(std::string_view text,
                                       std::optional<std::uint16_t> standard_port = {});
std::string to_string(const Endpoint& end);

Endpoint endpoint_of(const SocketAddress& address);

// The address of a host that is written as one, without a zone.
std::optional<HostAddress> address_of(const Endpoint& end);
// Whether the host is a name, and none of the forms of an address.
bool has_name(const Endpoint& end);

}  // namespace etcm::port
