#include "firmware/profile/number_reader.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "firmware/profile/toml_values.h"

namespace etcm::firmware {

namespace {

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
      table.mistake(*node, std::string("'scale' is no factor; ") + how_to_write_number);
    }
  }
  if (const toml::node* const node = table.find("offset")) {
    const auto offset = nano_of(*node);
    if (offset) {
      number.offset_nano = *offset;
    } else {
      table.mistake(*node, std::string("'offset' is no number; ") + how_to_write_number);
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

}  // namespace

std::uint64_t bits_of(const Number& number) {
  const unsigned bits = 16u * std::min<std::uint16_t>(number.span.count, 4);
  const std::uint64_t all = ~std::uint64_t{0} >> (64 - bits);
  return number.mask & all;
}

void read_type(TomlTable& table, Number& number) {
  if (const NumberType* const type =
          read_word(table, "type", std::span<const Word<NumberType>>(types))) {
    number.type = *type;
  }
  number.span.count = read_count(table, number.type);
}

void read_meaning(TomlTable& table, Number& number) {
  read_order(table, number);
  read_mask(table, number);
  read_scale(table, number);
  read_none(table, number);
}

}  // namespace etcm::firmware
