// One number in neighbouring registers of a device: where it stands and how it is written.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "firmware/profile/fraction.h"
#include "firmware/profile/sweep.h"

namespace etcm::firmware {

enum class NumberType : std::uint8_t {
  i16,
  u16,
  i32,
  u32,
  i64,
  u64,
  f32,
  f64,
  bcd16,
  bcd32,
  ascii,  // "4807.038", "12.5W": two characters in each register
};

inline constexpr std::uint16_t ascii_registers_max = 16;

// How many registers one has; of ascii the most.
constexpr std::uint16_t register_count_of(NumberType type) {
  switch (type) {
    case NumberType::i16:
    case NumberType::u16:
    case NumberType::bcd16:
      return 1;
    case NumberType::i32:
    case NumberType::u32:
    case NumberType::f32:
    case NumberType::bcd32:
      return 2;
    case NumberType::i64:
    case NumberType::u64:
    case NumberType::f64:
      return 4;
    case NumberType::ascii:
      return ascii_registers_max;
  }
  return 0;
}
constexpr bool is_real(NumberType type) {
  return type == NumberType::f32 || type == NumberType::f64;
}
constexpr bool is_bcd(NumberType type) {
  return type == NumberType::bcd16 || type == NumberType::bcd32;
}

// Big-endian unless said: the highest byte first in a register, the highest register first.
struct RegisterOrder {
  bool are_bytes_swapped = false;  // in each register
  bool are_words_swapped = false;  // in each pair of registers
  bool are_pairs_swapped = false;
  friend constexpr bool operator==(const RegisterOrder&, const RegisterOrder&) = default;
};

// What numbers come out in: 10^-9. They reach to some 9.2e9.
inline constexpr std::int64_t nano_per_one = 1'000'000'000;

struct Number {
  RegisterSpan span{.first = 0, .count = 1};
  NumberType type = NumberType::u16;
  RegisterOrder order;
  std::uint64_t mask = ~std::uint64_t{0};  // other bits count as 0
  Fraction scale = Fraction::of(1);
  std::int64_t offset_nano = 0;     // after the scale
  std::vector<std::uint64_t> none;  // bits of the mask that mean that there is no number
  friend bool operator==(const Number&, const Number&) = default;
};

struct FieldValue {
  enum class State : std::uint8_t {
    value,
    none,          // what the device writes where it has no number; NaN, infinity, blank text
    malformed,     // a BCD digit above 9, a text that is no number
    other_axis,    // a longitude with N or S, a latitude with E or W
    no_letter,     // where the letter of a hemisphere is to stand there is something else
    out_of_range,  // outside the range of the field, or beyond what can be counted
  };
  State state = State::none;
  std::int64_t nano = 0;  // never the least of its type; 0 where it is beyond that
  char letter = '\0';     // of a hemisphere, that was read with it

  bool is_value() const { return state == State::value; }
  double to_double() const { return static_cast<double>(nano) / 1e9; }
};

constexpr bool is_hemisphere(char c) { return c == 'N' || c == 'S' || c == 'E' || c == 'W'; }

// Integers and texts are exact until they are rounded to 10^-9, once; reals are computed in double.
// The value is multiplied by 10^exponent too. REQUIRES: -18 <= exponent <= 18.
FieldValue decode(const Number& number, const Sweep& sweep, int exponent = 0);

}  // namespace etcm::firmware
