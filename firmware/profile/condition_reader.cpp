#include "firmware/profile/condition_reader.h"

#include <bit>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "firmware/profile/number_reader.h"
#include "firmware/profile/toml_values.h"

namespace etcm::firmware {

namespace {

using Interval = Condition::Interval;
constexpr std::int64_t least_nano = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t most_nano = std::numeric_limits<std::int64_t>::max();

// A letter has its code in the bits of the mask.
std::optional<std::int64_t> tested_nano_of(const Number& number, const toml::node& node) {
  const auto text = node.value_exact<std::string>();
  const bool is_letter = text && text->size() == 1 && !((*text)[0] >= '0' && (*text)[0] <= '9');
  if (!is_letter) return nano_of(node);
  if (number.type != NumberType::u16 || number.scale != Fraction::of(1)) return std::nullopt;
  const auto code = std::int64_t{static_cast<unsigned char>((*text)[0])};
  return (code << std::countr_zero(bits_of(number))) * nano_per_one;
}

// Whether some registers make this number of it.
bool can_be(const Number& number, std::int64_t nano) {
  const bool is_plain = number.scale == Fraction::of(1) && number.offset_nano == 0 &&
                        !is_real(number.type) && !is_bcd(number.type) &&
                        number.type != NumberType::ascii;
  if (!is_plain) return true;
  if (nano % nano_per_one != 0) return false;
  const std::int64_t value = nano / nano_per_one;
  const std::uint64_t bits = bits_of(number);
  const std::uint64_t all = ~std::uint64_t{0} >> (64 - 16u * number.span.count);
  const bool is_signed = number.type == NumberType::i16 || number.type == NumberType::i32 ||
                         number.type == NumberType::i64;
  const std::uint64_t high = ~(all >> 1);
  if (value >= 0) {
    return (static_cast<std::uint64_t>(value) & (is_signed ? ~bits | high : ~bits)) == 0;
  }
  const auto low = static_cast<std::uint64_t>(value);
  return is_signed && (low & high) == high && (low & all & ~bits) == 0;
}

std::optional<std::int64_t> read_tested(TomlTable& table, const char* key, const Number& number,
                                        const toml::node& node) {
  const auto nano = tested_nano_of(number, node);
  if (nano && can_be(number, *nano)) return nano;
  const std::string text = node.value_exact<std::string>().value_or("");
  if (!nano && number.type == NumberType::ascii && node.is_string()) {
    table.mistake(node, quoted_key(key) +
                            " compares an ascii number with a text; give a number, or look at the "
                            "letter of one byte without 'type' and 'count': { register = 200, mask "
                            "= 0xFF00, equals = \"A\" }");
    return std::nullopt;
  }
  if (nano && text.size() == 1 && text[0] >= '0' && text[0] <= '9') {
    table.mistake(node, quoted_key(key) + " = \"" + text +
                            "\" is the number, not the digit, and the bits of this test never have "
                            "it; give the code of the digit, where the bits of the mask stand: 0x" +
                            std::to_string(30 + text[0] - '0') + " in a low byte, 0x" +
                            std::to_string(30 + text[0] - '0') + "00 in a high one");
    return std::nullopt;
  }
  table.mistake(node, quoted_key(key) +
                          (nano ? " is a number that the registers of this test never have (see "
                                  "'type' and 'mask'); correct it"
                                : " is no number and no letter; write it as 1, 0x57, \"0.5\" or "
                                  "\"A\""));
  return std::nullopt;
}

void read_equals(TomlTable& table, const char* key, Condition& condition) {
  const toml::node* const node = table.find(key);
  if (node == nullptr) return;
  const auto take = [&](const toml::node& element) {
    if (const auto nano = read_tested(table, key, condition.number, element)) {
      condition.any_of.push_back({.least = *nano, .most = *nano});
    }
  };
  if (const toml::array* const list = node->as_array()) {
    if (list->empty()) {
      table.mistake(*node, quoted_key(key) + " is an empty list; give a number, or several");
    }
    for (const toml::node& element : *list) take(element);
  } else {
    take(*node);
  }
}

void read_limits(TomlTable& table, Condition& condition) {
  Interval interval{.least = least_nano, .most = most_nano};
  for (const auto& [key, limit] :
       {std::pair{"at_least", &interval.least}, {"at_most", &interval.most}}) {
    const toml::node* const node = table.find(key);
    if (node == nullptr) continue;
    const auto nano = nano_of(*node);
    if (nano) {
      *limit = *nano;
    } else {
      table.mistake(*node, quoted_key(key) + " is no number; " + how_to_write_number);
    }
  }
  if (interval.least > interval.most) {
    table.mistake(*table.find("at_least"), "'at_least' is more than 'at_most'; exchange them");
  }
  condition.any_of.push_back(interval);
}

}  // namespace

void read_comparison(TomlTable& table, Condition& condition) {
  const bool has_equals = table.find("equals") != nullptr;
  const bool has_not_equals = table.find("not_equals") != nullptr;
  const bool has_limits = table.find("at_least") != nullptr || table.find("at_most") != nullptr;
  if (has_equals + has_not_equals + has_limits != 1) {
    return table.mistake(
        table.table(),
        "a test needs one of 'equals', 'not_equals', and 'at_least' or 'at_most'; write "
        "it as { register = 200, equals = 1 }");
  }
  condition.is_negated = has_not_equals;
  if (has_limits) {
    read_limits(table, condition);
  } else {
    read_equals(table, has_equals ? "equals" : "not_equals", condition);
  }
}

}  // namespace etcm::firmware
