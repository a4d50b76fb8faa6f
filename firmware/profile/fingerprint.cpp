#include "firmware/profile/fingerprint.h"

#include <concepts>
#include <optional>
#include <string>
#include <vector>

namespace etcm::firmware {

namespace {

class Fingerprint {
 public:
  std::uint64_t value() const { return value_; }

  template <std::integral Integer>
  void add(Integer number) {
    value_ = (value_ ^ static_cast<std::uint64_t>(number)) * 0x9e3779b97f4a7c15u;
    value_ ^= value_ >> 32;
  }
  void add(const std::string& text) {
    add(text.size());
    for (const char letter : text) add(static_cast<unsigned char>(letter));
  }
  template <class Value>
  void add(const std::optional<Value>& value) {
    add(value.has_value());
    if (value) add(*value);
  }
  template <class Value>
  void add(const std::vector<Value>& values) {
    add(values.size());
    for (const Value& value : values) add(value);
  }
  void add(const Number& number) {
    add(number.span.first);
    add(number.span.count);
    add(static_cast<int>(number.type));
    add(number.order.are_bytes_swapped);
    add(number.order.are_words_swapped);
    add(number.order.are_pairs_swapped);
    add(number.mask);
    add(number.scale.numerator);
    add(number.scale.denominator);
    add(number.offset_nano);
    add(number.none);
  }
  void add(const Condition::Interval& interval) {
    add(interval.least);
    add(interval.most);
  }
  void add(const Condition& condition) {
    add(condition.number);
    add(condition.any_of);
    add(condition.is_negated);
  }
  void add(const Field& field) {
    add(field.parts);
    add(field.has_sign_of_first);
    add(field.exponent);
    add(static_cast<int>(field.format));
    add(field.negative_if);
    add(field.least);
    add(field.most);
    // What had none before there were any keeps its number.
    if (field.factor) add(*field.factor);
  }

 private:
  std::uint64_t value_ = 0;
};

}  // namespace

std::uint64_t fingerprint(const Profile& profile, const Profile::Reading& reading) {
  Fingerprint print;
  print.add(profile.function);
  print.add(reading.name);
  print.add(reading.unit);
  print.add(reading.value);
  print.add(reading.valid);
  return print.value();
}

}  // namespace etcm::firmware
