// Lengths as their squares: exact, and in the order of the lengths themselves.
#pragma once

#include <compare>
#include <cstdint>

#include "etcm/types.h"

namespace etcm {
inline namespace ETCM_IDS {

// The square of a distance, in squared sub-units; exact.
struct SquaredLength {
  std::uint64_t high = 0;
  std::uint64_t low = 0;
  friend constexpr auto operator<=>(const SquaredLength&, const SquaredLength&) = default;
};

// Between two places with coordinates of at most 2^52 in magnitude. O(1).
[[nodiscard]] SquaredLength squared_distance(const Point& a, const Point& b) noexcept;

// The least whole number of units that is not shorter: the range a device needs for that distance.
// O(1).
[[nodiscard]] std::uint32_t range_for(const SquaredLength& length) noexcept;

}  // namespace ETCM_IDS
}  // namespace etcm
