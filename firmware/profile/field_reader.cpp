#include "firmware/profile/field_reader.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>

#include "firmware/profile/condition_reader.h"
#include "firmware/profile/number_reader.h"
#include "firmware/profile/toml_values.h"

namespace etcm::firmware {

namespace {

constexpr std::int64_t register_end = 0x10000;

// 180 / pi, nearer than 10^-17 of itself, with room for a scale.
constexpr Fraction degrees_per_radian{.numerator = 1204537366, .denominator = 21023143};
struct Format {
  FieldFormat format = FieldFormat::number;
  bool is_radians = false;
};
constexpr Word<Format> formats[] = {
    {"degrees", {FieldFormat::number, false}},
    {"radians", {FieldFormat::number, true}},
    {"ddmm.mmmm", {FieldFormat::ddmm, false}},
    {"ddmmss.ss", {FieldFormat::ddmmss, false}},
};

void read_range(TomlTable& table, Field& field) {
  const toml::node* const node = table.find("range");
  if (node == nullptr) return;
  const toml::array* const pair = node->as_array();
  if (pair != nullptr && pair->size() == 2) {
    field.least = nano_of(*pair->get(0));
    field.most = nano_of(*pair->get(1));
    if (field.least && field.most && *field.least <= *field.most) return;
    if (pair->get(0)->is_floating_point() || pair->get(1)->is_floating_point()) {
      return table.mistake(*node,
                           "'range' has a number with a point, which stands in quotes, so that it "
                           "is exact; write it as range = [\"0.5\", \"1\"]");
    }
    if (field.least && field.most) {
      return table.mistake(*node, "'range' has its most before its least; exchange them");
    }
  }
  table.mistake(*node,
                "'range' must be the least and the most; write it as range = [\"-40\", \"85.5\"]");
}

void read_format(TomlTable& table, Field& field) {
  const Format* const format = read_word(table, "format", std::span<const Word<Format>>(formats));
  if (format == nullptr) return;
  field.format = format->format;
  if (!format->is_radians) return;
  for (Number& part : field.parts) {
    const auto scale = multiply(part.scale, degrees_per_radian);
    const auto offset = scaled(part.offset_nano, degrees_per_radian);
    if (!scale || !offset) {
      return table.mistake(
          *table.find("format"),
          "'scale' or 'offset' has too many digits for radians; give 9 at the most");
    }
    part.scale = *scale;
    part.offset_nano = *offset;
  }
}

constexpr const char* number_keys[] = {"register", "type",  "count",  "order",
                                       "mask",     "scale", "offset", "none"};

}  // namespace

RegisterSpan FieldReader::read_registers(TomlTable& table, std::uint16_t count) const {
  table.require("register", "register = 200");
  RegisterSpan span{.first = 0, .count = count};
  const toml::node* const node = table.find("register");
  if (node == nullptr) return span;
  const auto given = node->value_exact<std::int64_t>();
  const std::int64_t first = counts_from_.value_or(0);
  if (!given) {
    if (!tell_of_no_number(table, "register", *node, std::to_string(first))) {
      table.mistake(
          *node, "'register' is no whole number; write it as register = " + std::to_string(first));
    }
    return span;
  }
  ++registers_;
  if (*given >= first && *given <= first + register_end - count) {
    span.first = static_cast<std::uint16_t>(*given - first);
  } else if (counts_from_) {
    out_of_range_.push_back({.node = node, .given = *given, .count = count});
  }
  return span;
}

void FieldReader::tell_registers(TomlTable& profile) const {
  const std::int64_t first = counts_from_.value_or(0);
  const std::string range =
      std::to_string(first) + " to " + std::to_string(first + register_end - 1);
  const std::size_t count = out_of_range_.size();
  if (count > 1 && count == registers_) {
    const toml::node* const key = profile.find("counts_from");
    const std::string all = "none of its " + std::to_string(count) + " registers, such as " +
                            std::to_string(out_of_range_.front().given) + ", is among those from " +
                            range;
    if (key != nullptr) {
      return profile.mistake(
          *key, "'counts_from' is what the manual calls the first register, and " + all +
                    "; give what the manual calls it, or take it out where "
                    "the registers are as on the wire");
    }
    return profile.mistake(*out_of_range_.front().node,
                           all +
                               "; add counts_from = 30001, 40001, 300001 or 400001, what the "
                               "manual calls the first register");
  }
  for (const OutOfRange& wrong : out_of_range_) {
    profile.mistake(*wrong.node, "'register' is out of range for a number of " +
                                     std::to_string(wrong.count) +
                                     (wrong.count == 1 ? " register" : " registers") +
                                     "; give a whole number from " + std::to_string(first) +
                                     " to " + std::to_string(first + register_end - wrong.count));
  }
}

Number FieldReader::read_number(TomlTable& table) const {
  Number number;
  read_type(table, number);
  number.span = read_registers(table, number.span.count);
  read_meaning(table, number);
  return number;
}

Condition FieldReader::read_condition(TomlTable& table) const {
  Condition condition{.number = read_number(table), .any_of = {}, .is_negated = false};
  read_comparison(table, condition);
  return condition;
}

void FieldReader::read_parts(TomlTable& table, Field& field) const {
  const toml::node* const node = table.find("parts");
  if (node == nullptr) {
    field.parts.push_back(read_number(table));
    return;
  }
  for (const char* const key : number_keys) {
    const toml::node* const beside = table.find(key);
    if (beside == nullptr) continue;
    table.mistake(*beside, quoted_key(key) + " beside 'parts'; give it to each part that needs it");
  }
  const toml::array* const list = node->as_array();
  if (list == nullptr || list->empty()) {
    table.mistake(
        *node,
        "'parts' must be a list; write it as parts = [{ register = 10 }, { register = 11, "
        "scale = \"1/60\" }]");
    return;
  }
  for (const toml::node& element : *list) {
    read_inner(table, "parts", element,
               [&](TomlTable& inner) { field.parts.push_back(read_number(inner)); });
  }
}

Field FieldReader::read_field(TomlTable& table) const {
  Field field;
  read_parts(table, field);
  read_format(table, field);
  read_range(table, field);
  if (const toml::node* const node = table.find("sign_of_first")) {
    field.has_sign_of_first = node->value_exact<bool>().value_or(false);
    if (field.parts.size() < 2 || !node->value_exact<bool>()) {
      table.mistake(*node,
                    "'sign_of_first' is true or false, and about several 'parts'; take it out");
    }
  }
  if (const toml::node* const node = table.find("exponent")) {
    read_inner(table, "exponent", *node,
               [&](TomlTable& inner) { field.exponent = read_number(inner); });
  }
  if (const toml::node* const node = table.find("factor")) {
    read_inner(table, "factor", *node,
               [&](TomlTable& inner) { field.factor = read_number(inner); });
  }
  if (const toml::node* const node = table.find("negative_if")) {
    read_inner(table, "negative_if", *node,
               [&](TomlTable& inner) { field.negative_if = read_condition(inner); });
  }
  return field;
}

std::optional<Field> FieldReader::read_field_of(TomlTable& table, const std::string& key) const {
  const toml::node* const node = table.find(key);
  if (node == nullptr) return std::nullopt;
  std::optional<Field> field;
  read_inner(table, key, *node, [&](TomlTable& inner) { field = read_field(inner); });
  return field;
}

std::vector<Condition> FieldReader::read_conditions_of(TomlTable& table,
                                                       const std::string& key) const {
  std::vector<Condition> conditions;
  const toml::node* const node = table.find(key);
  if (node == nullptr) return conditions;
  const auto read = [&](TomlTable& inner) { conditions.push_back(read_condition(inner)); };
  if (const toml::array* const list = node->as_array()) {
    for (const toml::node& element : *list) read_inner(table, key, element, read);
  } else {
    read_inner(table, key, *node, read);
  }
  return conditions;
}

}  // namespace etcm::firmware
