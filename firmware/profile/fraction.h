// A factor as a profile writes it: exact, so that a scale of 1/60000 loses nothing.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace etcm::firmware {

struct Fraction {
  std::int64_t numerator = 0;    // never the least of its type
  std::int64_t denominator = 1;  // above 0; in lowest terms

  friend constexpr bool operator==(const Fraction&, const Fraction&) = default;

  // "12", "-0.001", "1e-7", "1/60000"; nothing for anything else, and for what does not fit.
  static std::optional<Fraction> parse(std::string_view text);
  static constexpr Fraction of(std::int64_t whole) { return {.numerator = whole}; }

  double to_double() const {
    return static_cast<double>(numerator) / static_cast<double>(denominator);
  }
};

inline constexpr int power_of_ten_max = 18;
// 10^exponent. REQUIRES: -power_of_ten_max <= exponent <= power_of_ten_max.
Fraction power_of_ten(int exponent);

// Nothing where it does not fit.
std::optional<Fraction> multiply(const Fraction& a, const Fraction& b);
std::optional<std::int64_t> add(std::int64_t a, std::int64_t b);

// The integer nearest to the product, which is exact until then; halves go away from zero. Nothing
// where it does not fit, or is the least of its type.
std::optional<std::int64_t> scaled(std::int64_t value, const Fraction& factor);

}  // namespace etcm::firmware
