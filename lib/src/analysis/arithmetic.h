// Lengths and quotients for the analysis. Lengths, which every edge needs, are in the integers of
// this build; the rest is asked of few places, and is in limbs on every machine: it needs up to 350
// bits.
#pragma once

#include "base/check.h"
#include "etcm/analysis.h"
#include "geometry/lengths.h"
#include "geometry/wide_int.h"

namespace etcm::internal {

using Wide = LimbArithmetic;
using Int128 = Limbs<4>;
using Int256 = Limbs<8>;
using Int512 = Limbs<16>;

// A vector between two places, each part at most 2^53.
struct Vector {
  std::int64_t x;
  std::int64_t y;
};

inline Vector between(const Point& from, const Point& to) noexcept {
  return {to.x - from.x, to.y - from.y};
}

constexpr Int128 widened(std::int64_t value) noexcept { return Wide::product(value, 1); }

template <std::size_t Count>
constexpr Limbs<2 * Count> widened(const Limbs<Count>& value) noexcept {
  Limbs<2 * Count> wide;
  for (std::size_t i = 0; i < 2 * Count; ++i) {
    wide.limb[i] = i < Count ? value.limb[i] : value.is_negative() ? ~std::uint32_t{0} : 0u;
  }
  return wide;
}

template <std::size_t Count>
constexpr Limbs<Count> twice(const Limbs<Count>& value) noexcept {
  return value + value;
}

inline Int128 dot(const Vector& a, const Vector& b) noexcept {
  return Wide::product(a.x, b.x) + Wide::product(a.y, b.y);
}
inline Int128 cross(const Vector& a, const Vector& b) noexcept {
  return Wide::product(a.x, b.y) - Wide::product(a.y, b.x);
}

inline Int128 limbs(const SquaredLength& length) noexcept {
  return {{static_cast<std::uint32_t>(length.low), static_cast<std::uint32_t>(length.low >> 32),
           static_cast<std::uint32_t>(length.high), static_cast<std::uint32_t>(length.high >> 32)}};
}

// n / d rounded to the nearest, halves up; d > 0, and the result below 2^62 in magnitude.
inline std::int64_t rounded_quotient(const Int256& n, const Int128& d) noexcept {
  const Int128 divisor = twice(d);
  const Int256 dividend = twice(n) + widened(d);
  std::int64_t quotient = -(std::int64_t{1} << 62);
  for (int bit = 62; bit >= 0; --bit) {
    const std::int64_t next = quotient + (std::int64_t{1} << bit);
    const Int256 rest = dividend - Wide::product(widened(next), divisor);
    if (!rest.is_negative()) quotient = next;
  }
  return quotient;
}

}  // namespace etcm::internal
