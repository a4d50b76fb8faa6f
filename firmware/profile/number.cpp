#include "firmware/profile/number.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <string_view>

namespace etcm::firmware {

namespace {

using State = FieldValue::State;
using Registers = std::span<const std::uint16_t>;

// value * 10^exponent
struct Decimal {
  std::int64_t value = 0;
  int exponent = 0;
};

constexpr std::uint16_t swap_bytes(std::uint16_t value) {
  return static_cast<std::uint16_t>(value << 8 | value >> 8);
}

std::uint64_t raw_of(const Number& number, Registers registers) {
  const std::size_t swapped =
      (number.order.are_words_swapped ? 1u : 0u) + (number.order.are_pairs_swapped ? 2u : 0u);
  std::uint64_t raw = 0;
  for (std::size_t i = 0; i < registers.size(); ++i) {
    const std::uint16_t word = registers[i ^ (swapped & (registers.size() - 1))];
    raw = raw << 16 | (number.order.are_bytes_swapped ? swap_bytes(word) : word);
  }
  return raw;
}

// Nothing where a digit is above 9.
std::optional<std::int64_t> bcd_of(std::uint64_t raw) {
  std::int64_t value = 0;
  for (int shift = 28; shift >= 0; shift -= 4) {
    const std::uint64_t digit = raw >> shift & 0xf;
    if (digit > 9) return std::nullopt;
    value = value * 10 + static_cast<std::int64_t>(digit);
  }
  return value;
}

// Nothing where it does not fit: an unsigned one of 64 bits that is too large.
std::optional<std::int64_t> integer_of(NumberType type, std::uint64_t raw) {
  if (type == NumberType::i16) return static_cast<std::int16_t>(raw);
  if (type == NumberType::i32) return static_cast<std::int32_t>(raw);
  if (type == NumberType::u64 && raw > std::uint64_t{INT64_MAX}) return std::nullopt;
  return static_cast<std::int64_t>(raw);
}

FieldValue in_range(std::optional<std::int64_t> nano) {
  return {.state = nano ? State::value : State::out_of_range, .nano = nano.value_or(0)};
}

FieldValue value_of(const Number& number, Decimal decimal) {
  if (decimal.value == 0) return in_range(number.offset_nano);
  if (std::abs(decimal.exponent) > power_of_ten_max) return in_range(std::nullopt);
  const auto power = multiply(number.scale, power_of_ten(decimal.exponent));
  const auto factor = power ? multiply(*power, Fraction::of(nano_per_one)) : std::nullopt;
  const auto nano = factor ? scaled(decimal.value, *factor) : std::nullopt;
  return in_range(nano ? add(*nano, number.offset_nano) : std::nullopt);
}

FieldValue value_of(const Number& number, double value, int exponent) {
  if (!std::isfinite(value)) return {};
  const double nano =
      std::nearbyint(value * number.scale.to_double() * power_of_ten(exponent).to_double() * 1e9 +
                     static_cast<double>(number.offset_nano));
  // Not beyond this: a little farther it would not fit.
  if (!(std::abs(nano) < 9.2e18)) return in_range(std::nullopt);
  return in_range(static_cast<std::int64_t>(nano));
}

// Reals of 32 bits have some seven digits; the shortest decimal that is the same real has no
// others, which would be those of its double. Nothing where whole numbers are rounded, where the
// scale is no decimal, and for what decimals cannot count.
std::optional<FieldValue> shortest_value_of(const Number& number, float value, int exponent) {
  constexpr float exact_end = 1 << 24;
  const bool is_decimal = power_of_ten(power_of_ten_max).numerator % number.scale.denominator == 0;
  if (!is_decimal || !(std::abs(value) < exact_end)) return std::nullopt;
  std::array<char, 32> text;
  const auto written =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific);
  // "-1.2345e-03"
  Decimal decimal;
  const char* at = text.data() + (text[0] == '-' ? 1 : 0);
  bool has_point = false;
  for (; at != written.ptr && *at != 'e'; ++at) {
    if (*at == '.') {
      has_point = true;
      continue;
    }
    decimal.value = decimal.value * 10 + (*at - '0');
    if (has_point) --decimal.exponent;
  }
  if (text[0] == '-') decimal.value = -decimal.value;
  const bool is_negative = at + 1 < written.ptr && at[1] == '-';
  int power = 0;
  std::from_chars(std::min<const char*>(at + 2, written.ptr), written.ptr, power);
  decimal.exponent += (is_negative ? -power : power) + exponent;
  const FieldValue found = value_of(number, decimal);
  return found.is_value() ? std::optional(found) : std::nullopt;
}

// ---- Texts.

constexpr bool is_blank(char c) { return c == ' ' || c == '\0'; }
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }
// Takes away what tells the sign, and returns it: a sign, or the letter of a hemisphere at either
// end, or nothing. A sign that is beside a letter stays, and is malformed: nobody knows which of
// them counts.
char take_sign(std::string_view& text) {
  if (text.empty()) return '\0';
  const char first = text.front();
  if (first == '-' || first == '+' || is_hemisphere(first)) {
    text.remove_prefix(1);
    return first;
  }
  const char last = text.back();
  if (!is_hemisphere(last)) return '\0';
  text.remove_suffix(1);
  return last;
}

// Digits with at most one point. Nothing for anything else, and for more than fit.
std::optional<Decimal> decimal_of(std::string_view text, char sign) {
  const bool is_negative = sign == '-' || sign == 'S' || sign == 'W';
  Decimal decimal;
  bool has_digit = false;
  bool has_point = false;
  for (const char c : text) {
    if (c == '.' && !has_point) {
      has_point = true;
      continue;
    }
    if (!is_digit(c)) return std::nullopt;
    has_digit = true;
    const bool is_full = decimal.value > INT64_MAX / 10 - 1;
    if (is_full && !has_point) return std::nullopt;
    // What is behind this is far below 10^-9.
    if (is_full || decimal.exponent == -power_of_ten_max) continue;
    decimal.value = decimal.value * 10 + (c - '0');
    if (has_point) --decimal.exponent;
  }
  if (!has_digit) return std::nullopt;
  if (is_negative) decimal.value = -decimal.value;
  return decimal;
}

FieldValue text_value_of(const Number& number, Registers registers, int exponent) {
  std::array<char, std::size_t{2} * ascii_registers_max> letters;
  std::size_t size = 0;
  for (const std::uint16_t word : registers) {
    const std::uint16_t ordered = number.order.are_bytes_swapped ? swap_bytes(word) : word;
    letters[size++] = static_cast<char>(ordered >> 8);
    letters[size++] = static_cast<char>(ordered & 0xff);
  }
  std::string_view text(letters.data(), size);
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  if (text.empty()) return {};
  const char sign = take_sign(text);
  auto decimal = decimal_of(text, sign);
  if (!decimal) return {.state = State::malformed};
  decimal->exponent += exponent;
  FieldValue value = value_of(number, *decimal);
  if (is_hemisphere(sign)) value.letter = sign;
  return value;
}

}  // namespace

FieldValue decode(const Number& number, const Sweep& sweep, int exponent) {
  const Registers registers = sweep.at(number.span);
  if (registers.empty()) return {};
  if (number.type == NumberType::ascii) return text_value_of(number, registers, exponent);
  const std::uint64_t raw = raw_of(number, registers) & number.mask;
  if (std::find(number.none.begin(), number.none.end(), raw) != number.none.end()) return {};
  if (number.type == NumberType::f32) {
    const auto value = std::bit_cast<float>(static_cast<std::uint32_t>(raw));
    if (const auto shortest = shortest_value_of(number, value, exponent)) return *shortest;
    return value_of(number, static_cast<double>(value), exponent);
  }
  if (number.type == NumberType::f64) return value_of(number, std::bit_cast<double>(raw), exponent);
  if (is_bcd(number.type)) {
    const auto value = bcd_of(raw);
    if (!value) return {.state = State::malformed};
    return value_of(number, Decimal{.value = *value, .exponent = exponent});
  }
  const auto value = integer_of(number.type, raw);
  return value ? value_of(number, Decimal{.value = *value, .exponent = exponent})
               : in_range(std::nullopt);
}

}  // namespace etcm::firmware
