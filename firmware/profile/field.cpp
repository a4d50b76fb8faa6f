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

// With a gain that stands in a register.
FieldValue product_of(const Field& field, const Sweep& sweep) {
  FieldValue product = sum_of(field, sweep);
  if (!product.is_value() || !field.factor) return product;
  const FieldValue factor = decode(*field.factor, sweep);
  if (!factor.is_value()) return {.state = factor.state};
  const auto nano = scaled(product.nano, {.numerator = factor.nano, .denominator = nano_per_one});
  if (!nano) return out_of_range;
  product.nano = *nano;
  return product;
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

// What the registers have in the mask of the number, as the code of a letter; nothing where that
// can be none.
std::optional<std::int64_t> code_of(const Number& number, std::int64_t nano) {
  const bool is_plain = (number.type == NumberType::u16 || number.type == NumberType::i16) &&
                        number.scale == Fraction::of(1) && number.offset_nano == 0;
  if (!is_plain || nano < 0 || nano % nano_per_one != 0) return std::nullopt;
  return nano / nano_per_one >> std::countr_zero(number.mask);
}

bool is_small(char letter) { return letter >= 'a' && letter <= 'z'; }
char large(char letter) {
  return is_small(letter) ? static_cast<char>(letter - 'a' + 'A') : letter;
}

// The letter of a hemisphere whose code that is, small or not; else '\0'.
char hemisphere_of(const Number& number, std::int64_t nano) {
  const std::optional<std::int64_t> code = code_of(number, nano);
  const char letter = code && *code < 128 ? static_cast<char>(*code) : '\0';
  return is_hemisphere(large(letter)) ? letter : '\0';
}

// Whether a letter of a hemisphere is among what the test compares with, small or not.
bool asks_for_hemisphere(const Condition& condition, bool small) {
  return std::any_of(condition.any_of.begin(), condition.any_of.end(), [&](const auto& interval) {
    if (interval.least != interval.most) return false;
    const char letter = hemisphere_of(condition.number, interval.least);
    return letter != '\0' && is_small(letter) == small;
  });
}

// A device may have the letter of one side only.
bool is_blank(const Number& number, std::int64_t nano) {
  constexpr std::int64_t two_blanks = 0x2020;
  const std::int64_t code = code_of(number, nano).value_or(-1);
  return code == 0 || code == ' ' || code == two_blanks;
}

// That is read beside the number where a letter makes it negative; '\0' where none does, and where
// there is a blank. Nothing where something else stands there, which would be taken for positive.
std::optional<char> letter_beside(const Field& field, const Sweep& sweep) {
  if (field.axis == Axis::none || !field.negative_if) return '\0';
  const Condition& test = *field.negative_if;
  const bool knows_small = asks_for_hemisphere(test, true);
  const bool knows_large = asks_for_hemisphere(test, false);
  if (!knows_small && !knows_large) return '\0';
  const FieldValue found = decode(test.number, sweep);
  if (!found.is_value()) return '\0';
  const char letter = hemisphere_of(test.number, found.nano);
  if (letter != '\0' && (is_small(letter) ? knows_small : knows_large)) return large(letter);
  return is_blank(test.number, found.nano) ? std::optional('\0') : std::nullopt;
}

}  // namespace

std::vector<char> hemispheres_of(const Condition& condition) {
  std::vector<char> letters;
  for (const Condition::Interval& interval : condition.any_of) {
    if (interval.least != interval.most) continue;
    const char letter = hemisphere_of(condition.number, interval.least);
    if (letter != '\0') letters.push_back(large(letter));
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
  FieldValue value = product_of(field, sweep);
  if (!value.is_value()) return value;
  if (value.letter == '\0') {
    const std::optional<char> letter = letter_beside(field, sweep);
    if (!letter) return {.state = State::no_letter};
    value.letter = *letter;
  }
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
  if (field.factor) spans.push_back(field.factor->span);
  if (field.negative_if) add_spans(*field.negative_if, spans);
}

}  // namespace etcm::firmware
