// The predicates' filter for machines that compute doubles in software: integers of 64 bits, which
// decide nearly all questions in a tenth of the time that the exact stage takes there.
//
// Nodes stand on whole units, and those of one question near each other as a rule: their
// differences in units have few bits, and the determinant is exact in as many as a machine has.
// Else the differences are at most 2^53; all are shifted right alike until they fit 30 bits and a
// sign. A component that is shifted is floor(d / 2^s), too small by less than 1. Where no bit is
// lost it is exact, as it is for nodes far from each other: s is at most 24, and their differences
// are multiples of 2^28.
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

// As unsigned: of a signed shift compilers keep 64 bits, and multiply those.
inline std::int32_t upper_word(std::int64_t value) noexcept {
  return static_cast<std::int32_t>(static_cast<std::uint64_t>(value) >> 32);
}

// REQUIRES: 0 < shift < 32. By words, for a machine of 32 bits cannot know that.
inline std::int32_t narrow(std::int32_t low, std::int32_t high, unsigned shift) noexcept {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(low) >> shift |
                                   static_cast<std::uint32_t>(high) << (32 - shift));
}
inline std::int32_t narrow(std::int64_t component, unsigned shift) noexcept {
  return narrow(static_cast<std::int32_t>(component), upper_word(component), shift);
}

// What a component has but for its sign's bits.
inline std::uint32_t magnitude(std::int32_t component) noexcept {
  return static_cast<std::uint32_t>(component ^ component >> 31);
}

// Of the points from `origin`; returns whether no bit is lost. Where all are so near that two bits
// less are enough, two are shifted out all the same. `out` has room for twice as many: the words of
// the differences are kept there, of x and of y, until they are narrowed.
inline bool narrow_all(const Point* const* points, std::size_t count, const Point& origin,
                       NarrowOffset* out) noexcept {
  std::uint32_t low_bits = 0, high_words = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t x = points[i]->x - origin.x, y = points[i]->y - origin.y;
    low_bits |= static_cast<std::uint32_t>(x) | static_cast<std::uint32_t>(y);
    high_words |= magnitude(upper_word(x)) | magnitude(upper_word(y));
    out[2 * i] = {static_cast<std::int32_t>(x), upper_word(x)};
    out[2 * i + 1] = {static_cast<std::int32_t>(y), upper_word(y)};
  }
  const auto shift = static_cast<unsigned>(std::bit_width(high_words) + 32 - narrow_bits);
  for (std::size_t i = 0; i < count; ++i) {
    const NarrowOffset x = out[2 * i], y = out[2 * i + 1];
    out[i] = {narrow(x.x, x.y, shift), narrow(y.x, y.y, shift)};
  }
  return low_bits >> shift << shift == low_bits;
}

// Of components of so few bits a lift and a cross product are at most 2^29 in size, and the
// incircle determinant is below 2^60.
inline constexpr int short_bits = 14;

// The points from `origin` in units, where all are whole and as short as short_bits says; returns
// whether that is so.
inline bool shorten_all(const Point* const* points, std::size_t count, const Point& origin,
                        NarrowOffset* out) noexcept {
  auto low_bits = static_cast<std::uint32_t>(origin.x) | static_cast<std::uint32_t>(origin.y);
  for (std::size_t i = 0; i < count; ++i) {
    low_bits |= static_cast<std::uint32_t>(points[i]->x) | static_cast<std::uint32_t>(points[i]->y);
  }
  if (low_bits << (32 - subunit_bits) != 0) return false;
  std::uint32_t magnitudes = 0;
  const std::int32_t x0 = narrow(origin.x, subunit_bits), y0 = narrow(origin.y, subunit_bits);
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t x = narrow(points[i]->x, subunit_bits) - x0;
    const std::int32_t y = narrow(points[i]->y, subunit_bits) - y0;
    magnitudes |= magnitude(x) | magnitude(y);
    out[i] = {x, y};
  }
  return magnitudes >> short_bits == 0;
}

// a * b by products of 32 bits. REQUIRES: both in [-2^30, 2^30].
inline constexpr std::int64_t split_product(std::int32_t a, std::int32_t b) noexcept {
  const std::int32_t a_high = a >> 16, b_high = b >> 16;
  const std::int32_t a_low = a & 0xffff, b_low = b & 0xffff;
  // At most 2^31 - 2^15 in size.
  const std::int32_t middle = a_high * b_low + a_low * b_high;
  const auto low = static_cast<std::uint32_t>(a_low) * static_cast<std::uint32_t>(b_low);
  const std::int32_t high = a_high * b_high;
  return (std::int64_t{high} << 32) + (std::int64_t{middle} << 16) + low;
}

// REQUIRES: as split_product.
inline std::int64_t narrow_product(std::int32_t a, std::int32_t b) noexcept {
#if defined(__arm__) && defined(__thumb__) && !defined(__thumb2__)
  // It has no longer products, and a compiler would take those of 64 by 64.
  return split_product(a, b);
#else
  return std::int64_t{a} * b;
#endif
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
  NarrowOffset at[4];
  const bool is_exact = narrow_all(points, 2, c, at);
  const std::int64_t value = narrow_cross(at[0], at[1]);
  if (is_exact) return sign_of(value);
  return size_of(value) >= size_of(at[0]) + size_of(at[1]) + 2 ? sign_of(value) : undecided;
}

inline std::int32_t short_cross(const NarrowOffset& a, const NarrowOffset& b) noexcept {
  return a.x * b.y - a.y * b.x;
}

// The determinant of the three from at[0] on; the two behind them are the first two again.
// REQUIRES: components of at most short_bits bits and a sign.
inline std::int64_t short_incircle(const NarrowOffset* at) noexcept {
  std::int64_t value = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int32_t lift = at[i].x * at[i].x + at[i].y * at[i].y;
    value += narrow_product(lift, short_cross(at[i + 1], at[i + 2]));
  }
  return value;
}

// The sign of the same, of narrow components, or `undecided`.
//
// A lift l of narrow components differs from the true one by at most 2 (|X| + |Y|) + 2 <= 2^32 + 2,
// a cross product k too, as above. Over 2^32, rounded down, they are at most 2^29 in size and wrong
// by at most 2 + 2^-31; so a term l k is wrong by less than (2 + 2^-31) (l + |k|) + 4.1, and all
// three by less than twice the sum s of their sizes, which is below 2^32, plus 15. Their sum is at
// most 3 * 2^58.
inline int narrow_incircle(const NarrowOffset* at) noexcept {
  std::int64_t value = 0;
  std::uint32_t sizes = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int32_t lift = upper_word(narrow_lift(at[i]));
    const std::int32_t cross = upper_word(narrow_cross(at[i + 1], at[i + 2]));
    value += narrow_product(lift, cross);
    sizes += static_cast<std::uint32_t>(lift) + magnitude(cross) + 1;
  }
  return size_of(value) >= 2 * std::int64_t{sizes} + 15 ? sign_of(value) : undecided;
}

// The sign of incircle(a, b, c, d), or `undecided`. A call, so that the exact stage after it has
// its stack.
[[gnu::noinline]] inline int incircle_narrow(const Point& a, const Point& b, const Point& c,
                                             const Point& d) noexcept {
  const Point* const points[] = {&a, &b, &c};
  NarrowOffset at[6];
  const bool is_short = shorten_all(points, 3, d, at);
  if (!is_short) narrow_all(points, 3, d, at);
  at[3] = at[0];
  at[4] = at[1];
  return is_short ? sign_of(short_incircle(at)) : narrow_incircle(at);
}

}  // namespace etcm::internal
