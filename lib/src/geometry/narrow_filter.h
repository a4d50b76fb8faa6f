// The predicates' filter for machines that compute doubles in software: integers of 64 bits, which
// decide nearly all questions in a tenth of the time that the exact stage takes there.
//
// The differences of the points are at most 2^53; all are shifted right alike until they fit 30
// bits and a sign. A component that is shifted is floor(d / 2^s), too small by less than 1. Where
// no bit is lost it is exact, as it is for nodes alone: their differences are multiples of 2^28,
// and s is at most 23.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "base/assumptions.h"
#include "etcm/types.h"

namespace etcm::internal {

// What a filter says that cannot tell the sign.
inline constexpr int undecided = 2;

inline constexpr int sign_of(std::int64_t value) noexcept { return (value > 0) - (value < 0); }
inline constexpr std::int64_t size_of(std::int64_t value) noexcept {
  return value < 0 ? -value : value;
}

// A point as seen from another, shifted: each component is in [-2^30, 2^30).
struct NarrowOffset {
  std::int32_t x;
  std::int32_t y;
};

inline constexpr int narrow_bits = 30;
// Components of so few bits, in units, have an incircle determinant below 2^60.
inline constexpr int short_bits = 14;

// What the shift made of them.
enum class Narrowed : std::uint8_t {
  inexact,
  exact,
  whole,  // exact, in units, and short
};

// REQUIRES: shift < 32. By words, for a machine of 32 bits cannot know that.
inline std::int32_t narrow(std::int64_t component, unsigned shift) noexcept {
  const auto low = static_cast<std::uint32_t>(component);
  const auto high = static_cast<std::uint32_t>(component >> 32);
  return static_cast<std::int32_t>(low >> shift | (high << 1) << (31 - shift));
}

// What a component has but for its sign's bits.
inline std::uint64_t magnitude(std::int64_t component) noexcept {
  return static_cast<std::uint64_t>(component ^ (component >> 63));
}

// Of the points from `origin`. Each difference is taken twice: that is smaller than to keep them.
inline Narrowed narrow_all(const Point* const* points, std::size_t count, const Point& origin,
                           NarrowOffset* out) noexcept {
  std::uint32_t low_bits = 0;
  std::uint64_t magnitudes = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t x = points[i]->x - origin.x, y = points[i]->y - origin.y;
    low_bits |= static_cast<std::uint32_t>(x | y);
    magnitudes |= magnitude(x) | magnitude(y);
  }
  const int width = static_cast<int>(std::bit_width(magnitudes));
  auto shift = static_cast<unsigned>(width > narrow_bits ? width - narrow_bits : 0);
  const bool is_whole = low_bits << (32 - subunit_bits) == 0 && width <= short_bits + subunit_bits;
  if (is_whole) shift = subunit_bits;
  for (std::size_t i = 0; i < count; ++i) {
    out[i] = {narrow(points[i]->x - origin.x, shift), narrow(points[i]->y - origin.y, shift)};
  }
  if (is_whole) return Narrowed::whole;
  return low_bits >> shift << shift == low_bits ? Narrowed::exact : Narrowed::inexact;
}

inline std::int64_t narrow_product(std::int32_t a, std::int32_t b) noexcept {
  return std::int64_t{a} * b;
}

// At most 2^61 in size, as a lift is.
inline std::int64_t narrow_cross(const NarrowOffset& a, const NarrowOffset& b) noexcept {
  return narrow_product(a.x, b.y) - narrow_product(a.y, b.x);
}

inline std::int64_t narrow_lift(const NarrowOffset& a) noexcept {
  return narrow_product(a.x, a.x) + narrow_product(a.y, a.y);
}

inline std::int64_t size_of(const NarrowOffset& a) noexcept {
  return size_of(std::int64_t{a.x}) + size_of(std::int64_t{a.y});
}

// The sign of orient2d(a, b, c), or `undecided`.
//
// (X + e)(Y + f) differs from XY by less than |X| + |Y| + 1 for e and f in [0, 1): the cross
// product of the true components from that of the narrow ones by less than their sizes plus 2.
inline int orient2d_narrow(const Point& a, const Point& b, const Point& c) noexcept {
  const Point* const points[] = {&a, &b};
  NarrowOffset at[2];
  const Narrowed kind = narrow_all(points, 2, c, at);
  const std::int64_t value = narrow_cross(at[0], at[1]);
  if (kind != Narrowed::inexact) return sign_of(value);
  return size_of(value) >= size_of(at[0]) + size_of(at[1]) + 2 ? sign_of(value) : undecided;
}

// The determinant of narrow components, as long as it fits.
inline std::int64_t short_incircle(const NarrowOffset& a, const NarrowOffset& b,
                                   const NarrowOffset& c) noexcept {
  return narrow_lift(a) * narrow_cross(b, c) + narrow_lift(b) * narrow_cross(c, a) +
         narrow_lift(c) * narrow_cross(a, b);
}

// One of the three terms of the determinant over 2^62, and the sizes that bound its error.
struct NarrowTerm {
  std::int64_t value;
  std::int64_t sizes;
};

inline NarrowTerm narrow_term(const NarrowOffset& a, const NarrowOffset& b,
                              const NarrowOffset& c) noexcept {
  const auto lift = static_cast<std::int32_t>(narrow_lift(a) >> 31);
  const auto cross = static_cast<std::int32_t>(narrow_cross(b, c) >> 31);
  return {narrow_product(lift, cross), lift + size_of(std::int64_t{cross})};
}

// The sign of incircle(a, b, c, d), or `undecided`.
//
// A lift l of narrow components differs from the true one by at most 2 (|X| + |Y|) + 2 <= 2^32 + 2,
// a cross product k too, as above. Over 2^31, rounded down, they are at most 2^30 in size and wrong
// by at most 3 + 2^-30; so a term is wrong by less than 3.01 (l + |k|) + 9.1, and all three by less
// than 4 times the sum of their sizes plus 28. Their sum is at most 3 * 2^60.
inline int incircle_narrow(const Point& a, const Point& b, const Point& c,
                           const Point& d) noexcept {
  const Point* const points[] = {&a, &b, &c};
  NarrowOffset at[3];
  if (narrow_all(points, 3, d, at) == Narrowed::whole) {
    return sign_of(short_incircle(at[0], at[1], at[2]));
  }
  std::int64_t value = 0;
  std::int64_t sizes = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const NarrowTerm term = narrow_term(at[i], at[(i + 1) % 3], at[(i + 2) % 3]);
    value += term.value;
    sizes += term.sizes;
  }
  return size_of(value) >= 4 * sizes + 28 ? sign_of(value) : undecided;
}

}  // namespace etcm::internal
