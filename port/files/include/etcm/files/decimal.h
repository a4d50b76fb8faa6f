// Decimal numbers as they stand in files, exactly: never through a binary fraction, so that "0.1"
// times 10 is 1.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "etcm/files/text_sink.h"

namespace etcm::files {

class Decimal {
 public:
  Decimal() = default;  // zero

  // Optional sign, digits with at most one point, optional exponent: "-12", ".5", "3.", "1e3".
  // Nothing else: no blanks, "inf", "nan", hexadecimal. None for anything else, and for a number of
  // more than 1000 characters.
  static std::optional<Decimal> parse(std::string_view text);
  static Decimal of(std::int64_t value);

  bool is_zero() const { return digits_.empty(); }
  bool is_negative() const { return negative_; }
  bool is_integer() const { return exponent_ >= 0; }
  // The nearest integer; halves go away from zero.
  Decimal rounded() const;
  // None where it is no integer or does not fit.
  std::optional<std::int64_t> to_integer() const;
  double to_double() const;
  // Every digit; with an exponent only where zeros would be longer than 40 digits.
  std::string to_string() const;

  friend Decimal operator*(const Decimal& a, const Decimal& b);
  friend bool operator==(const Decimal& a, const Decimal& b) = default;

 private:
  void normalize();

  // The value is digits * 10^exponent; no zeros at either end, so equal values have equal members.
  std::string digits_;
  std::int64_t exponent_ = 0;
  bool negative_ = false;
};

// Writes what is in 10^-9, every digit that is no zero at the end: 1234000000 is 1.234. `out` takes
// texts and integers. REQUIRES: not the least of its type.
template <class Out>
void write_nano(Out& out, std::int64_t nano) {
  constexpr std::int64_t one = 1'000'000'000;
  if (nano < 0) out << std::string_view("-");
  const std::int64_t size = nano < 0 ? -nano : nano;
  out << size / one;
  std::int64_t rest = size % one;
  if (rest == 0) return;
  out << std::string_view(".");
  for (std::int64_t digit = one / 10; rest > 0; digit /= 10) {
    out << rest / digit;
    rest %= digit;
  }
}

// Writes the decimal of a coordinate in sub-units (etcm/types.h), every digit: at most 28 behind
// the point, none for a whole unit.
void write_coordinate(TextSink& out, std::int64_t subunits);
std::string coordinate_text(std::int64_t subunits);

}  // namespace etcm::files
