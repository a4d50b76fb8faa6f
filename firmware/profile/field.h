// What a device says in one or several numbers: a coordinate, a measured value, whether it is good.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "firmware/profile/number.h"

namespace etcm::firmware {

// A test of a number.
struct Condition {
  struct Interval {
    std::int64_t least = 0;  // in 10^-9, as `most`
    std::int64_t most = 0;
    friend bool operator==(const Interval&, const Interval&) = default;
  };
  Number number;
  std::vector<Interval> any_of;
  bool is_negated = false;

  // False where there is no number.
  bool holds(const Sweep& sweep) const;
  friend bool operator==(const Condition&, const Condition&) = default;
};

// How an angle is written.
enum class FieldFormat : std::uint8_t {
  number,  // as it is
  ddmm,    // degrees times 100, and minutes: 4807.038 is 48 degrees and 7.038 minutes
  ddmmss,  // degrees times 10000, minutes times 100, and seconds
};

// What an angle is counted along: the letters of the other one have no place in it.
enum class Axis : std::uint8_t { none, longitude, latitude };

constexpr bool belongs_to(char hemisphere, Axis axis) {
  const bool is_of_latitude = hemisphere == 'N' || hemisphere == 'S';
  return axis == Axis::none || is_of_latitude == (axis == Axis::latitude);
}

struct Field {
  std::vector<Number> parts;       // their sum, with nothing where one is nothing
  bool has_sign_of_first = false;  // the other parts are sizes, with the sign of the first
  std::optional<Number> exponent;  // each part is multiplied by 10 to the power of this
  std::optional<Number> factor;    // the sum is multiplied by this too
  FieldFormat format = FieldFormat::number;
  Axis axis = Axis::none;
  std::optional<Condition> negative_if;
  // In 10^-9, of what comes out.
  std::optional<std::int64_t> least;
  std::optional<std::int64_t> most;
  friend bool operator==(const Field&, const Field&) = default;
};

FieldValue decode(const Field& field, const Sweep& sweep);

// The letters of hemispheres that the test asks for, by their codes.
std::vector<char> hemispheres_of(const Condition& condition);

// Appends the registers that it needs.
void add_spans(const Condition& condition, std::vector<RegisterSpan>& spans);
void add_spans(const Field& field, std::vector<RegisterSpan>& spans);

}  // namespace etcm::firmware
