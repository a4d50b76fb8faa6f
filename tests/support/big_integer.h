// GMP's integers from ours.
#pragma once

#include <gmpxx.h>

#include <cstdint>

namespace etcm::test {

// GMP takes long, which does not have 64 bits everywhere.
inline mpz_class integer(std::int64_t value) {
  return mpz_class(static_cast<long>(value >> 32)) * (mpz_class(1) << 32) +
         mpz_class(static_cast<unsigned long>(value & 0xffff'ffff));
}

}  // namespace etcm::test
