// How much memory the process has.
#pragma once

#include <cstdint>

namespace etcm::port {

// In RAM, in bytes; 0 where the system does not tell.
std::uint64_t resident_bytes();

// What malloc() has given out and has not back, to whatever part of the process; in bytes. Takes
// some microseconds, and more the more pieces of it are free.
std::uint64_t heap_bytes();

}  // namespace etcm::port
