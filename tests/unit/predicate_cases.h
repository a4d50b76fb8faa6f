// Families of four points on which a predicate is likely to be wrong, if it ever is.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <span>

#include "etcm/types.h"
#include "support/emulated.h"
#include "support/sanitized.h"

namespace etcm::test {

using FourPoints = std::array<etcm::Point, 4>;

inline constexpr std::int64_t coordinate_max = std::int64_t{1} << 52;

// AddressSanitizer makes the oracle's allocations fiftyfold slower, and has nothing to find in more
// of the same arithmetic.
inline constexpr int thinning = is_address_sanitized ? 20 : thinning_if_slow;

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  std::int64_t between(std::int64_t low, std::int64_t high) {
    return std::uniform_int_distribution<std::int64_t>(low, high)(engine_);
  }
  etcm::Point point(std::int64_t magnitude) {
    return {between(-magnitude, magnitude), between(-magnitude, magnitude)};
  }

 private:
  std::mt19937_64 engine_;
};

struct Family {
  const char* name;
  FourPoints (*make)(Random& random);
};

std::span<const Family> families();

}  // namespace etcm::test
