#include "http/host_check.h"

#include <algorithm>
#include <optional>

#include "etcm/port/endpoint.h"

namespace etcm::port {

RequestedHost check_host(std::string_view host, std::span<const std::string> names) {
  constexpr std::uint16_t of_http = 80;
  const std::optional<Endpoint> end = parse_endpoint(host, of_http);
  if (!end) return {};
  if (!has_name(*end)) return {.is_known = true, .name = {}};
  std::string name = end->host;
  if (name.ends_with('.')) name.pop_back();
  const bool is_known =
      name == "localhost" || std::find(names.begin(), names.end(), name) != names.end();
  return {.is_known = is_known, .name = is_known ? std::string() : std::move(name)};
}

std::string unknown_host_text(const RequestedHost& host) {
  const std::string name = host.name.empty() ? "the.name.of.this.gateway" : host.name;
  return "421: this gateway is not known by the name that it was asked for" +
         (host.name.empty() ? std::string() : ", " + host.name) +
         ".\n\n"
         "If that is its name, say so in its settings and have it read them again\n"
         "(systemctl reload etcm-gateway):\n\n"
         "    [http]\n"
         "    names = [\"" +
         name +
         "\"]\n\n"
         "Its address works without that.\n\n"
         "If you do not know the name, a page of another site has tried to read this one\n"
         "through your browser. It was told nothing.\n";
}

}  // namespace etcm::port
