// Text out, without a heap or a C library's stdio. Each machine has its own way out (see
// README.md).
#pragma once

#include <cstdint>

namespace etcm::test {

// Supplied by the machine.
void put(const char* text);

void put_number(std::uint64_t value);
// All 16 digits.
void put_hex(std::uint64_t value);

}  // namespace etcm::test
