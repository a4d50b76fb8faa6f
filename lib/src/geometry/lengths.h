// What is reckoned with squared lengths.
#pragma once

#include "etcm/length.h"

namespace etcm::internal {

inline SquaredLength sum(const SquaredLength& a, const SquaredLength& b) noexcept {
  const std::uint64_t low = a.low + b.low;
  return {a.high + b.high + (low < a.low ? 1u : 0u), low};
}

// (2^doublings * units)^2, for doublings of at most 3.
inline SquaredLength squared_range(std::uint32_t units, int doublings) noexcept {
  const std::uint64_t square = std::uint64_t{units} * units;
  const int shift = 2 * (subunit_bits + doublings);
  return {square >> (64 - shift), square << shift};
}

}  // namespace etcm::internal
