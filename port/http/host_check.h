// Whether a request means this server.
//
// A browser sends the name that it was asked for as Host. A page of another site can have its own
// name lead to this machine once it is loaded (DNS rebinding): to the browser both are one site
// then, and the page reads here what it likes. Such a request has a name of that site. By an
// address nobody can do the same.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace etcm::port {

// What a Host header comes to.
struct RequestedHost {
  bool is_known = false;
  std::string name;  // where it is not known: in lower case, empty where that is no name at all
};

// Known are all addresses, "localhost" and `names`, which are in lower case and end in no dot; with
// a port or without.
RequestedHost check_host(std::string_view host, std::span<const std::string> names);

// For a person who has come by that name: why there is nothing to see, and what to do.
std::string unknown_host_text(const RequestedHost& host);

}  // namespace etcm::port
