#include "firmware/profile/field_reader.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <span>
#include <string_view>
#include <utility>

namespace etcm::firmware {

namespace {

constexpr std::int64_t register_end = 0x10000;

template <class Value>
struct Word {
  std::string_view word;
  Value value;
};

constexpr Word<NumberType> types[] = {
    {"i16", NumberType::i16},     {"u16", NumberType::u16},     {"i32", NumberType::i32},
    {"u32", NumberType::u32},     {"i64", NumberType::i64},     {"u64", NumberType::u64},
    {"f32", NumberType::f32},     {"f64", NumberType::f64},     {"bcd16", NumberType::bcd16},
    {"bcd32", NumberType::bcd32}, {"ascii", NumberType::ascii},
};
// The first letter is the highest byte. Four letters order 64 bits in the same way.
constexpr Word<RegisterOrder> orders[] = {
    {"ABCD", {false, false, false}},     {"BADC", {true, false, false}},
    {"CDAB", {false, true, true}},       {"DCBA", {true, true, true}},
    {"AB", {false, false, false}},       {"BA", {true, false, false}},
    {"ABCDEFGH", {false, false, false}}, {"BADCFEHG", {true, false, false}},
    {"CDABGHEF", {false, true, false}},  {"DCBAHGFE", {true, true, false}},
    {"EFGHABCD", {false, false, true}},  {"FEHGBADC", {true, false, true}},
    {"GHEFCDAB", {false, true, true}},   {"HGFEDCBA", {true, true, true}},
};
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

std::string quoted(std::string_view key) { return "'" + std::string(key) + "'"; }

template <class Value>
const Value* read_word(TomlTable& table, const char* key, std::span<const Word<Value>> words) {
  const toml::node* const node = table.find(key);
  if (node == nullptr) return nullptr;
  const auto text = node->value_exact<std::string>();
  std::string list;
  for (const Word<Value>& word : words) {
    if (text && *text == word.word) return &word.value;
    list += (list.empty() ? "\"" : ", \"") + std::string(word.word) + "\"";
  }
  table.mistake(*node, quoted(key) + " is unknown; write one of " + list);
  return nullptr;
}

// Where a text or a list stands for a number. False: neither does.
bool tell_of_no_number(TomlTable& table, const char* key, const toml::node& node,
                       const std::string& example) {
  if (node.is_string()) {
    const std::string text = node.value_exact<std::string>().value_or("");
    const bool is_number =
        !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
    table.mistake(node, quoted(key) + " is a text; write the number without quotes: " + key +
                            " = " + (is_number ? text : example));
    return true;
  }
  if (!node.is_array()) return false;
  table.mistake(node, quoted(key) + " is a list; give one number: " + key + " = " + example);
  return true;
}

// ---- Numbers.

constexpr const char* how_to_write =
    "write it as 10, \"0.001\" or \"1/60000\" (a number with a point stands in quotes, so that it "
    "is "
    "exact)";

std::optional<Fraction> fraction_of(const toml::node& node) {
  if (const auto whole = node.value_exact<std::int64_t>()) {
    return *whole == INT64_MIN ? std::nullopt : std::optional(Fraction::of(*whole));
  }
  if (const auto text = node.value_exact<std::string>()) return Fraction::parse(*text);
  return std::nullopt;
}

// In 10^-9.
std::optional<std::int64_t> nano_of(const toml::node& node) {
  const auto fraction = fraction_of(node);
  return fraction ? scaled(nano_per_one, *fraction) : std::nullopt;
}

// The bits that the mask leaves; all where there is none.
std::uint64_t bits_of(const Number& number) {
  const unsigned bits = 16u * std::min<std::uint16_t>(number.span.count, 4);
  const std::uint64_t all = ~std::uint64_t{0} >> (64 - bits);
  return number.mask & all;
}

void read_mask(TomlTable& table, Number& number) {
  const toml::node* const node = table.find("mask");
  if (node == nullptr) return;
  if (is_real(number.type) || number.type == NumberType::ascii) {
    return table.mistake(*node, "'mask' has no meaning for f32, f64 and ascii; take it out");
  }
  const auto mask = node->value_exact<std::int64_t>();
  const std::uint64_t all = bits_of(number);
  if (mask && *mask != 0 && (static_cast<std::uint64_t>(*mask) & ~all) == 0) {
    number.mask = static_cast<std::uint64_t>(*mask);
    return;
  }
  table.mistake(*node, "'mask' has no bit, or more than its type; write it as mask = 0x00FF");
}

void read_scale(TomlTable& table, Number& number) {
  if (const toml::node* const node = table.find("scale")) {
    const auto scale = fraction_of(*node);
    if (scale && scale->numerator != 0) {
      number.scale = *scale;
    } else {
      table.mistake(*node, std::string("'scale' is no factor; ") + how_to_write);
    }
  }
  if (const toml::node* const node = table.find("offset")) {
    const auto offset = nano_of(*node);
    if (offset) {
      number.offset_nano = *offset;
    } else {
      table.mistake(*node, std::string("'offset' is no number; ") + how_to_write);
    }
  }
}

// Of "0xFFFF".
std::optional<std::uint64_t> hexadecimal_of(const toml::node& node) {
  const auto text = node.value_exact<std::string>();
  if (!text || !text->starts_with("0x")) return std::nullopt;
  std::uint64_t bits = 0;
  const char* const end = text->data() + text->size();
  const auto parsed = std::from_chars(text->data() + 2, end, bits, 16);
  if (parsed.ec != std::errc{} || parsed.ptr != end) return std::nullopt;
  return bits;
}

std::optional<std::uint64_t> real_bits_of(NumberType type, const toml::node& node) {
  const auto fraction = fraction_of(node);
  if (!fraction) return std::nullopt;
  const double value = fraction->to_double();
  if (type == NumberType::f64) return std::bit_cast<std::uint64_t>(value);
  return std::bit_cast<std::uint32_t>(static_cast<float>(value));
}

std::optional<std::uint64_t> integer_bits_of(const toml::node& node, std::uint64_t all) {
  const auto value = node.value_exact<std::int64_t>();
  if (!value) return std::nullopt;
  const auto bits = static_cast<std::uint64_t>(*value);
  // Of a negative one those above are all set.
  const bool fits = (bits & ~all) == 0 || (*value < 0 && (bits | all >> 1) == ~std::uint64_t{0});
  return fits ? std::optional(bits & all) : std::nullopt;
}

// The bits that mean no data; nothing where the registers of the number cannot have them.
std::optional<std::uint64_t> none_bits_of(const Number& number, const toml::node& node) {
  if (number.type == NumberType::ascii) return std::nullopt;
  const std::uint64_t all = ~std::uint64_t{0} >> (64 - 16u * number.span.count);
  auto bits = hexadecimal_of(node);
  if (!bits) {
    bits = is_real(number.type) ? real_bits_of(number.type, node) : integer_bits_of(node, all);
  }
  return bits && (*bits & ~bits_of(number)) == 0 ? bits : std::nullopt;
}

void read_none(TomlTable& table, Number& number) {
  const toml::node* const node = table.find("none");
  if (node == nullptr) return;
  const auto take = [&](const toml::node& element) {
    if (const auto bits = none_bits_of(number, element)) return number.none.push_back(*bits);
    table.mistake(element,
                  "'none' has a value that its type, or the mask, cannot have; write it as "
                  "none = 999999999, 0x7FFFFFFF, \"0xFFFFFFFFFFFFFFFF\" or a list of these");
  };
  if (const toml::array* const list = node->as_array()) {
    for (const toml::node& element : *list) take(element);
  } else {
    take(*node);
  }
}

std::uint16_t read_count(TomlTable& table, NumberType type) {
  if (type == NumberType::ascii) {
    table.require("count", "count = 5 (registers, two characters in each)");
    return static_cast<std::uint16_t>(
        read_whole(table, "count", 1, ascii_registers_max).value_or(1));
  }
  if (const toml::node* const node = table.find("count")) {
    table.mistake(*node, "'count' is for ascii alone, other types have a length; take it out");
  }
  return register_count_of(type);
}

void read_order(TomlTable& table, Number& number) {
  const RegisterOrder* const order =
      read_word(table, "order", std::span<const Word<RegisterOrder>>(orders));
  if (order == nullptr) return;
  const toml::node& node = *table.find("order");
  const std::size_t letters = node.value_exact<std::string>()->size();
  const std::uint16_t registers = number.type == NumberType::ascii ? 1 : number.span.count;
  if ((letters == 8 && registers < 4) || (letters == 2 && registers > 1)) {
    return table.mistake(node, std::string("'order' has ") + (letters == 8 ? "more" : "fewer") +
                                   " letters than the type has bytes; write one such as \"" +
                                   (registers == 1   ? "BA"
                                    : registers == 2 ? "CDAB"
                                                     : "GHEFCDAB") +
                                   "\"");
  }
  number.order = *order;
}

// ---- Fields.

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

// ---- Tests.

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
    table.mistake(node, quoted(key) +
                            " compares an ascii number with a text; give a number, or look at the "
                            "letter of one byte without 'type' and 'count': { register = 200, mask "
                            "= 0xFF00, equals = \"A\" }");
    return std::nullopt;
  }
  if (nano && text.size() == 1 && text[0] >= '0' && text[0] <= '9') {
    table.mistake(node, quoted(key) + " = \"" + text +
                            "\" is the number, not the digit, and the bits of this test never have "
                            "it; give the code of the digit, where the bits of the mask stand: 0x" +
                            std::to_string(30 + text[0] - '0') + " in a low byte, 0x" +
                            std::to_string(30 + text[0] - '0') + "00 in a high one");
    return std::nullopt;
  }
  table.mistake(
      node, quoted(key) + (nano ? " is a number that the registers of this test never have (see "
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
      table.mistake(*node, quoted(key) + " is an empty list; give a number, or several");
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
      table.mistake(*node, quoted(key) + " is no number; " + how_to_write);
    }
  }
  if (interval.least > interval.most) {
    table.mistake(*table.find("at_least"), "'at_least' is more than 'at_most'; exchange them");
  }
  condition.any_of.push_back(interval);
}

}  // namespace

std::optional<std::int64_t> read_whole(TomlTable& table, const char* key, std::int64_t least,
                                       std::int64_t most) {
  const toml::node* const node = table.find(key);
  if (node == nullptr) return std::nullopt;
  const auto value = node->value_exact<std::int64_t>();
  if (value && *value >= least && *value <= most) return value;
  if (tell_of_no_number(table, key, *node, std::to_string(least))) return std::nullopt;
  table.mistake(*node, quoted(key) + " is out of range; give a whole number from " +
                           std::to_string(least) + " to " + std::to_string(most));
  return std::nullopt;
}

std::optional<std::int64_t> read_positive(TomlTable& table, const char* key) {
  const toml::node* const node = table.find(key);
  if (node == nullptr) return std::nullopt;
  const auto nano = nano_of(*node);
  if (nano && *nano > 0) return nano;
  table.mistake(*node, std::string("'") + key +
                           "' must be a decimal above 0, in quotes; write it as " + key +
                           " = \"30\"");
  return std::nullopt;
}

std::string read_text(TomlTable& table, const char* key) {
  const toml::node* const node = table.find(key);
  if (node == nullptr) return "";
  std::string text = node->value_exact<std::string>().value_or("");
  const bool is_readable = std::none_of(text.begin(), text.end(), [](char c) {
    return static_cast<unsigned char>(c) < ' ' || c == '\x7f';
  });
  if (!text.empty() && is_readable) return text;
  table.mistake(*node, quoted(key) + " must be a text in one line; write it in quotes");
  return "";
}

void read_inner(TomlTable& table, const std::string& key, const toml::node& node,
                const std::function<void(TomlTable&)>& read) {
  if (!node.is_table()) {
    return table.mistake(
        node, quoted(key) + " must be a table; write it as " + key + " = { register = 200 }");
  }
  TomlTable inner = table.inner(key, *node.as_table());
  read(inner);
  inner.finish();
}

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
  if (const NumberType* const type =
          read_word(table, "type", std::span<const Word<NumberType>>(types))) {
    number.type = *type;
  }
  number.span = read_registers(table, read_count(table, number.type));
  read_order(table, number);
  read_mask(table, number);
  read_scale(table, number);
  read_none(table, number);
  return number;
}

Condition FieldReader::read_condition(TomlTable& table) const {
  Condition condition{.number = read_number(table), .any_of = {}, .is_negated = false};
  const bool has_equals = table.find("equals") != nullptr;
  const bool has_not_equals = table.find("not_equals") != nullptr;
  const bool has_limits = table.find("at_least") != nullptr || table.find("at_most") != nullptr;
  if (has_equals + has_not_equals + has_limits != 1) {
    table.mistake(table.table(),
                  "a test needs one of 'equals', 'not_equals', and 'at_least' or 'at_most'; write "
                  "it as { register = 200, equals = 1 }");
    return condition;
  }
  condition.is_negated = has_not_equals;
  if (has_limits) {
    read_limits(table, condition);
  } else {
    read_equals(table, has_equals ? "equals" : "not_equals", condition);
  }
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
    table.mistake(*beside, quoted(key) + " beside 'parts'; give it to each part that needs it");
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
