// How much memory the process has in RAM.
#pragma once

#include <cstdint>

namespace etcm::port {

// In bytes; 0 where the system does not tell.
std::uint64_t resident_bytes();

}  // namespace etcm::port
