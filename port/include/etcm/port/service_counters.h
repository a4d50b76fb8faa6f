// How a server is used; only ever grow, but for the clients.
#pragma once

#include <cstdint>

namespace etcm::port {

struct ServiceCounters {
  std::uint32_t clients = 0;  // connected now
  std::uint64_t requests = 0;
  std::uint64_t refused = 0;  // requests that were wrong, and clients that were turned away
};

}  // namespace etcm::port
