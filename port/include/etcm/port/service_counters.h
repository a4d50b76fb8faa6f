// How a server is used.
#pragma once

#include <cstdint>

namespace etcm::port {

struct ServiceCounters {
  bool is_listening = true;   // else nobody can connect: its port cannot be had
  std::uint32_t clients = 0;  // connected now
  // These only ever grow.
  std::uint64_t requests = 0;
  std::uint64_t rejected = 0;  // requests that were wrong, and clients that were rejected
};

}  // namespace etcm::port
