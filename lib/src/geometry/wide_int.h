// Signed integers of 128 and 256 bits, as far as the exact predicates need them: product, sum,
// difference, sign. One interface, two implementations:
//
//   NativeArithmetic  on the compiler's __int128 (64-bit targets)
//   LimbArithmetic    on 32-bit limbs with 64-bit products (32-bit ARM has nothing wider)
//
// Each offers Int128 and Int256 with + and -, and static functions
//   Int128 product(int64, int64), Int256 product(Int128, Int128), int sign(Int256 or Int128).
// All results are two's complement modulo their width, so they are exact where the value fits.
// No heap, no loops that depend on the values.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "base/assumptions.h"

namespace etcm::internal {

// Two's complement, least significant limb first. Without a value until one is given, as integers
// are.
template <std::size_t Count>
struct Limbs {
  std::array<std::uint32_t, Count> limb;

  constexpr bool is_negative() const noexcept { return (limb[Count - 1] >> 31) != 0; }

  friend constexpr Limbs operator+(const Limbs& a, const Limbs& b) noexcept {
    Limbs sum;
    std::uint64_t carry = 0;
    for (std::size_t i = 0; i < Count; ++i) {
      carry += std::uint64_t{a.limb[i]} + b.limb[i];
      sum.limb[i] = static_cast<std::uint32_t>(carry);
      carry >>= 32;
    }
    return sum;
  }

  friend constexpr Limbs operator-(const Limbs& a, const Limbs& b) noexcept {
    Limbs difference;
    std::uint64_t borrow = 0;
    for (std::size_t i = 0; i < Count; ++i) {
      const std::uint64_t digit = std::uint64_t{a.limb[i]} - b.limb[i] - borrow;
      difference.limb[i] = static_cast<std::uint32_t>(digit);
      borrow = digit >> 63;
    }
    return difference;
  }

  constexpr void subtract_from_upper_half(const Limbs<Count / 2>& a) noexcept {
    std::uint64_t borrow = 0;
    for (std::size_t i = 0; i < Count / 2; ++i) {
      const std::uint64_t digit = std::uint64_t{limb[i + Count / 2]} - a.limb[i] - borrow;
      limb[i + Count / 2] = static_cast<std::uint32_t>(digit);
      borrow = digit >> 63;
    }
  }
};

struct LimbArithmetic {
  using Int128 = Limbs<4>;
  using Int256 = Limbs<8>;

  template <std::size_t Count>
  static constexpr Limbs<2 * Count> product(const Limbs<Count>& a, const Limbs<Count>& b) noexcept {
    Limbs<2 * Count> result;
    for (std::size_t i = 0; i < Count; ++i) {
      std::uint64_t carry = 0;
      for (std::size_t j = 0; j < Count; ++j) {
        // Nothing is there before the first row. At most (2^32 - 1)^2 + 2 (2^32 - 1) = 2^64 - 1.
        carry += std::uint64_t{a.limb[i]} * b.limb[j] + (i == 0 ? 0 : result.limb[i + j]);
        result.limb[i + j] = static_cast<std::uint32_t>(carry);
        carry >>= 32;
      }
      result.limb[i + Count] = static_cast<std::uint32_t>(carry);
    }
    // Read as unsigned, a negative factor is too great by 2^(32 Count).
    if (a.is_negative()) result.subtract_from_upper_half(b);
    if (b.is_negative()) result.subtract_from_upper_half(a);
    return result;
  }

  // After the template: Clang would not have its body yet, were this computed while it compiles.
  static constexpr Int128 product(std::int64_t a, std::int64_t b) noexcept {
    return product(to_limbs(a), to_limbs(b));
  }

  template <std::size_t Count>
  static constexpr int sign(const Limbs<Count>& a) noexcept {
    if (a.is_negative()) return -1;
    for (const std::uint32_t limb : a.limb) {
      if (limb != 0) return 1;
    }
    return 0;
  }

 private:
  static constexpr Limbs<2> to_limbs(std::int64_t a) noexcept {
    const auto bits = static_cast<std::uint64_t>(a);
    return {{static_cast<std::uint32_t>(bits), static_cast<std::uint32_t>(bits >> 32)}};
  }
};

#ifdef __SIZEOF_INT128__

struct NativeArithmetic {
  __extension__ using Int128 = __int128;
  __extension__ using Uint128 = unsigned __int128;

  struct Int256 {
    Uint128 low;
    Uint128 high;

    friend constexpr Int256 operator+(const Int256& a, const Int256& b) noexcept {
      const Uint128 sum = a.low + b.low;
      return {sum, a.high + b.high + (sum < a.low ? 1u : 0u)};
    }
    friend constexpr Int256 operator-(const Int256& a, const Int256& b) noexcept {
      return {a.low - b.low, a.high - b.high - (a.low < b.low ? 1u : 0u)};
    }
  };

  static constexpr Int128 product(std::int64_t a, std::int64_t b) noexcept { return Int128{a} * b; }

  static constexpr Int256 product(const Int128& a, const Int128& b) noexcept {
    const auto ua = static_cast<Uint128>(a);
    const auto ub = static_cast<Uint128>(b);
    const Uint128 low_low = lower(ua) * lower(ub);
    const Uint128 low_high = lower(ua) * upper(ub);
    const Uint128 high_low = upper(ua) * lower(ub);
    const Uint128 middle = upper(low_low) + lower(low_high) + lower(high_low);
    Int256 result{lower(low_low) | (middle << 64),
                  upper(ua) * upper(ub) + upper(low_high) + upper(high_low) + upper(middle)};
    // Read as unsigned, a negative factor is too great by 2^128.
    if (a < 0) result.high -= ub;
    if (b < 0) result.high -= ua;
    return result;
  }

  static constexpr int sign(const Int128& a) noexcept { return (a > 0) - (a < 0); }

  static constexpr int sign(const Int256& a) noexcept {
    if (static_cast<Int128>(a.high) < 0) return -1;
    return (a.low | a.high) != 0 ? 1 : 0;
  }

 private:
  static constexpr Uint128 lower(Uint128 a) noexcept { return static_cast<std::uint64_t>(a); }
  static constexpr Uint128 upper(Uint128 a) noexcept { return a >> 64; }
};

#endif

#if defined(__SIZEOF_INT128__) && !defined(ETCM_FORCE_LIMBS)
using ExactArithmetic = NativeArithmetic;
#else
using ExactArithmetic = LimbArithmetic;
#endif

}  // namespace etcm::internal
