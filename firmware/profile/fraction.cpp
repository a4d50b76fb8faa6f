#include "firmware/profile/fraction.h"

#include <numeric>

#include "etcm/files/decimal.h"

namespace etcm::firmware {

namespace {

std::optional<Fraction> reduced(std::int64_t numerator, std::int64_t denominator) {
  if (denominator == 0 || numerator == INT64_MIN || denominator == INT64_MIN) return std::nullopt;
  if (denominator < 0) {
    numerator = -numerator;
    denominator = -denominator;
  }
  const std::int64_t common = std::gcd(numerator, denominator);
  return Fraction{.numerator = numerator / common, .denominator = denominator / common};
}

std::optional<Fraction> parse_decimal(std::string_view text) {
  const std::optional<files::Decimal> decimal = files::Decimal::parse(text);
  if (!decimal) return std::nullopt;
  for (int digits = 0; digits <= power_of_ten_max; ++digits) {
    const std::int64_t denominator = power_of_ten(digits).numerator;
    if (const auto whole = (*decimal * files::Decimal::of(denominator)).to_integer()) {
      return reduced(*whole, denominator);
    }
  }
  return std::nullopt;
}

constexpr std::uint64_t magnitude(std::int64_t value) {
  return value < 0 ? 0 - static_cast<std::uint64_t>(value) : static_cast<std::uint64_t>(value);
}

struct Product {
  std::uint64_t high = 0;
  std::uint64_t low = 0;
};

// In halves, for a 32-bit processor has no type that takes the whole.
constexpr Product wide_product(std::uint64_t a, std::uint64_t b) {
  constexpr std::uint64_t half = 0xffffffff;
  const std::uint64_t low = (a & half) * (b & half);
  const std::uint64_t cross = (a >> 32) * (b & half) + (low >> 32);
  const std::uint64_t other = (a & half) * (b >> 32) + (cross & half);
  return {.high = (a >> 32) * (b >> 32) + (cross >> 32) + (other >> 32),
          .low = other << 32 | (low & half)};
}

// Rounded; halves go up. REQUIRES: 0 < divisor < 2^63.
constexpr std::optional<std::uint64_t> quotient(Product dividend, std::uint64_t divisor) {
  if (dividend.high >= divisor) return std::nullopt;
  std::uint64_t rest = dividend.high;
  std::uint64_t result = 0;
  for (int bit = 63; bit >= 0; --bit) {
    rest = rest << 1 | (dividend.low >> bit & 1);
    result <<= 1;
    if (rest < divisor) continue;
    rest -= divisor;
    result |= 1;
  }
  if (rest < divisor - rest) return result;
  if (result == UINT64_MAX) return std::nullopt;
  return result + 1;
}

}  // namespace

std::optional<Fraction> Fraction::parse(std::string_view text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos) return parse_decimal(text);
  const auto above = parse_decimal(text.substr(0, slash));
  const auto below = parse_decimal(text.substr(slash + 1));
  if (!above || !below) return std::nullopt;
  const auto inverse = reduced(below->denominator, below->numerator);
  return inverse ? multiply(*above, *inverse) : std::nullopt;
}

Fraction power_of_ten(int exponent) {
  std::int64_t power = 1;
  for (int i = 0; i < (exponent < 0 ? -exponent : exponent); ++i) power *= 10;
  return exponent < 0 ? Fraction{.numerator = 1, .denominator = power} : Fraction::of(power);
}

std::optional<Fraction> multiply(const Fraction& a, const Fraction& b) {
  // What can be cancelled is cancelled first: the products are in lowest terms then.
  const std::int64_t ab = std::gcd(a.numerator, b.denominator);
  const std::int64_t ba = std::gcd(b.numerator, a.denominator);
  Fraction product;
  if (__builtin_mul_overflow(a.numerator / ab, b.numerator / ba, &product.numerator) ||
      __builtin_mul_overflow(a.denominator / ba, b.denominator / ab, &product.denominator) ||
      product.numerator == INT64_MIN) {
    return std::nullopt;
  }
  return product;
}

std::optional<std::int64_t> add(std::int64_t a, std::int64_t b) {
  std::int64_t sum = 0;
  if (__builtin_add_overflow(a, b, &sum) || sum == INT64_MIN) return std::nullopt;
  return sum;
}

std::optional<std::int64_t> scaled(std::int64_t value, const Fraction& factor) {
  const auto size = quotient(wide_product(magnitude(value), magnitude(factor.numerator)),
                             static_cast<std::uint64_t>(factor.denominator));
  if (!size || *size > std::uint64_t{INT64_MAX}) return std::nullopt;
  const auto result = static_cast<std::int64_t>(*size);
  return (value < 0) != (factor.numerator < 0) ? -result : result;
}

}  // namespace etcm::firmware
