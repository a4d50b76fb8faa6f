#include "firmware/profile/field.h"

#include <algorithm>
#include <bit>

namespace etcm::firmware {

namespace {

using State = FieldValue::State;

constexpr FieldValue out_of_range{.state = State::out_of_range, .nano = 0};

struct Exponent {
  State state = State::value;
  int value = 0;
};

Exponent exponent_of(const Field& field, const Sweep& sweep) {
  if (!field.exponent) return {};
  const FieldValue found = decode(*field.exponent, sweep);
  if (!found.is_value()) return {.state = found.state};
  const std::int64_t value = found.nano / nano_per_one;
  const bool is_whole = found.nano % nano_per_one == 0;
  if (!is_whole || value < -power_of_ten_max || value > power_of_ten_max) {
    return {.state = State::out_of_range};
  }
  return {.value = static_cast<int>(value)};
}

FieldValue sum_of(const Field& field, const Sweep& sweep) {
  const Exponent exponent = exponent_of(field, sweep);
  if (exponent.state != State::value) return {.state = exponent.state};
  FieldValue sum{.state = State::value, .nano = 0};
  bool is_turned = false;
  for (const Number& part : field.parts) {
    const FieldValue found = decode(part, sweep, exponent.value);
    if (!found.is_value()) return found;
    const auto total = add(sum.nano, is_turned ? -found.nano : found.nano);
    if (!total) return out_of_range;
    sum.nano = *total;
    if (found.letter != '\0') sum.letter = found.letter;
    if (&part == &field.parts.front()) is_turned = field.has_sign_of_first && found.nano < 0;
  }
  return sum;
}

constexpr std::int64_t sixty = 60 * nano_per_one;

// Of degrees times 100, and minutes. Nothing where there are 60 minutes or more.
std::optional<std::int64_t> degrees_of_ddmm(std::int64_t nano) {
  const std::int64_t degrees = nano / (100 * nano_per_one);
  const std::int64_t minutes = nano % (100 * nano_per_one);
  if (minutes <= -sixty || minutes >= sixty) return std::nullopt;
  return degrees * nano_per_one + (minutes + (minutes < 0 ? -30 : 30)) / 60;
}

std::optional<std::int64_t> degrees_of_ddmmss(std::int64_t nano) {
  const std::int64_t degrees = nano / (10'000 * nano_per_one);
  const std::int64_t minutes = nano / (100 * nano_per_one) % 100;
  const std::int64_t seconds = nano % (100 * nano_per_one);
  if (minutes <= -60 || minutes >= 60 || seconds <= -sixty || seconds >= sixty) return std::nullopt;
  const std::int64_t all_seconds = minutes * sixty + seconds;
  return degrees * nano_per_one + (all_seconds + (all_seconds < 0 ? -1800 : 1800)) / 3600;
}

std::optional<std::int64_t> formatted(FieldFormat format, std::int64_t nano) {
  switch (format) {
    case FieldFormat::number:
      break;
    case FieldFormat::ddmm:
      return degrees_of_ddmm(nano);
    case FieldFormat::ddmmss:
      return degrees_of_ddmmss(nano);
  }
  return nano;
}

// The letter of a hemisphere whose code the registers have that the number has in its mask; else
// '\0'.
char hemisphere_of(const Number& number, std::int64_t nano) {
  const bool is_plain = (number.type == NumberType::u16 || number.type == NumberType::i16) &&
                        number.scale == Fraction::of(1) && number.offset_nano == 0;
  if (!is_plain || nano < 0 || nano % nano_per_one != 0) return '\0';
  const std::int64_t code = nano / nano_per_one >> std::countr_zero(number.mask);
  const char letter = code < 128 ? static_cast<char>(code) : '\0';
  return is_hemisphere(letter) ? letter : '\0';
}

bool asks_for_hemisphere(const Condition& condition) {
  return std::any_of(condition.any_of.begin(), condition.any_of.end(), [&](const auto& interval) {
    return interval.least == interval.most &&
           hemisphere_of(condition.number, interval.least) != '\0';
  });
}

// That is read beside the number where a letter makes it negative.
char letter_beside(const Field& field, const Sweep& sweep) {
  if (field.axis == Axis::none || !field.negative_if) return '\0';
  if (!asks_for_hemisphere(*field.negative_if)) return '\0';
  const Number& number = field.negative_if->number;
  const FieldValue found = decode(number, sweep);
  return found.is_value() ? hemisphere_of(number, found.nano) : '\0';
}

}  // namespace

std::vector<char> hemispheres_of(const Condition& condition) {
  std::vector<char> letters;
  for (const Condition::Interval& interval : condition.any_of) {
    if (interval.least != interval.most) continue;
    const char letter = hemisphere_of(condition.number, interval.least);
    if (letter != '\0') letters.push_back(letter);
  }
  return letters;
}

bool Condition::holds(const Sweep& sweep) const {
  const FieldValue found = decode(number, sweep);
  if (!found.is_value()) return false;
  const bool is_in_one = std::any_of(any_of.begin(), any_of.end(), [&](const Interval& interval) {
    return found.nano >= interval.least && found.nano <= interval.most;
  });
  return is_in_one != is_negated;
}

FieldValue decode(const Field& field, const Sweep& sweep) {
  FieldValue value = sum_of(field, sweep);
  if (!value.is_value()) return value;
  if (value.letter == '\0') value.letter = letter_beside(field, sweep);
  if (value.letter != '\0' && !belongs_to(value.letter, field.axis)) {
    return {.state = State::other_axis, .letter = value.letter};
  }
  const auto nano = formatted(field.format, value.nano);
  if (!nano) return {.state = State::malformed};
  value.nano = field.negative_if && field.negative_if->holds(sweep) ? -*nano : *nano;
  const bool is_in_range =
      (!field.least || value.nano >= *field.least) && (!field.most || value.nano <= *field.most);
  if (!is_in_range) value.state = State::out_of_range;
  return value;
}

void add_spans(const Condition& condition, std::vector<RegisterSpan>& spans) {
  spans.push_back(condition.number.span);
}

void add_spans(const Field& field, std::vector<RegisterSpan>& spans) {
  for (const Number& part : field.parts) spans.push_back(part.span);
  if (field.exponent) spans.push_back(field.exponent->span);
  if (field.negative_if) add_spans(*field.negative_if, spans);
}

}  // namespace etcm::firmware
