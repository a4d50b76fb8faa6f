#include "values.h"

#include <array>
#include <bit>
#include <charconv>
#include <set>
#include <utility>

namespace etcm::bus {

namespace {

using firmware::WordOrder;

constexpr std::array<std::pair<std::string_view, ValueKind>, 8> kind_words{{
    {"u16", ValueKind::u16},
    {"i16", ValueKind::i16},
    {"u32", ValueKind::u32},
    {"i32", ValueKind::i32},
    {"hex", ValueKind::hex},
    {"float", ValueKind::real},
    {"int16", ValueKind::i16},
    {"int", ValueKind::i32},
}};

constexpr std::array<std::pair<std::string_view, WordOrder>, 4> order_words{{
    {"ABCD", WordOrder::abcd},
    {"BADC", WordOrder::badc},
    {"CDAB", WordOrder::cdab},
    {"DCBA", WordOrder::dcba},
}};

bool swaps_bytes(WordOrder order) { return order == WordOrder::badc || order == WordOrder::dcba; }
bool swaps_words(WordOrder order) { return order == WordOrder::cdab || order == WordOrder::dcba; }

std::uint16_t ordered_bytes(std::uint16_t value, WordOrder order) {
  return swaps_bytes(order) ? static_cast<std::uint16_t>(value << 8 | value >> 8) : value;
}

std::uint32_t ordered_words(std::uint32_t value, WordOrder order) {
  return swaps_words(order) ? value << 16 | value >> 16 : value;
}

// The whole text as a number of this type.
template <class Number>
std::optional<Number> number_in(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// A whole number from least to most, decimal or 0x...
std::optional<std::int64_t> whole_in(std::string_view text, std::int64_t least, std::int64_t most) {
  std::optional<std::int64_t> value;
  if (text.starts_with("0x") || text.starts_with("0X")) {
    const std::string_view digits = text.substr(2);
    std::uint32_t bits = 0;
    const auto [end, error] =
        std::from_chars(digits.data(), digits.data() + digits.size(), bits, 16);
    if (error == std::errc{} && end == digits.data() + digits.size()) value = bits;
  } else {
    value = number_in<std::int64_t>(text);
  }
  return value && *value >= least && *value <= most ? value : std::nullopt;
}

template <class Word>
std::optional<Word> find_word(const auto& words, std::string_view text) {
  for (const auto& [word, meaning] : words) {
    if (word == text) return meaning;
  }
  return std::nullopt;
}

}  // namespace

std::size_t ValueType::register_count() const {
  return kind == ValueKind::u32 || kind == ValueKind::i32 || kind == ValueKind::real ? 2 : 1;
}

std::optional<ValueKind> parse_value_kind(std::string_view text) {
  return find_word<ValueKind>(kind_words, text);
}

std::optional<WordOrder> parse_word_order(std::string_view text) {
  return find_word<WordOrder>(order_words, text);
}

std::string format_value(std::span<const std::uint16_t> registers, ValueType type) {
  std::uint32_t bits = ordered_bytes(registers[0], type.order);
  if (type.register_count() == 2) {
    bits = ordered_words(bits << 16 | ordered_bytes(registers[1], type.order), type.order);
  }
  switch (type.kind) {
    case ValueKind::u16:
    case ValueKind::u32:
      return std::to_string(bits);
    case ValueKind::i16:
      return std::to_string(static_cast<std::int16_t>(bits));
    case ValueKind::i32:
      return std::to_string(static_cast<std::int32_t>(bits));
    case ValueKind::hex: {
      constexpr std::string_view digits = "0123456789ABCDEF";
      std::string text = "0x";
      for (int shift = 12; shift >= 0; shift -= 4) text += digits[bits >> shift & 0xf];
      return text;
    }
    case ValueKind::real:
      break;
  }
  std::array<char, 32> text;
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), std::bit_cast<float>(bits)).ptr;
  return {text.data(), end};
}

bool parse_value(std::string_view text, ValueType type, std::vector<std::uint16_t>& registers) {
  std::optional<std::int64_t> value;
  switch (type.kind) {
    case ValueKind::u16:
    case ValueKind::hex:
      value = whole_in(text, 0, 0xffff);
      break;
    case ValueKind::i16:
      value = whole_in(text, -0x8000, 0x7fff);
      break;
    case ValueKind::u32:
      value = whole_in(text, 0, 0xffffffff);
      break;
    case ValueKind::i32:
      value = whole_in(text, -0x80000000ll, 0x7fffffff);
      break;
    case ValueKind::real:
      if (const auto real = number_in<float>(text)) value = std::bit_cast<std::uint32_t>(*real);
      break;
  }
  if (!value) return false;
  const auto bits = static_cast<std::uint32_t>(*value);
  if (type.register_count() == 2) {
    const std::uint32_t ordered = ordered_words(bits, type.order);
    registers.push_back(ordered_bytes(static_cast<std::uint16_t>(ordered >> 16), type.order));
    registers.push_back(ordered_bytes(static_cast<std::uint16_t>(ordered), type.order));
  } else {
    registers.push_back(ordered_bytes(static_cast<std::uint16_t>(bits), type.order));
  }
  return true;
}

std::optional<std::vector<std::uint8_t>> parse_unit_list(std::string_view text, int least) {
  constexpr int most = 247;
  std::set<std::uint8_t> units;
  while (true) {
    const std::size_t comma = text.find(',');
    const std::string_view part = text.substr(0, comma);
    const std::size_t dash = part.find_first_of(":-");
    const auto first = number_in<int>(part.substr(0, dash));
    const auto last =
        dash == std::string_view::npos ? first : number_in<int>(part.substr(dash + 1));
    if (!first || !last || *first < least || *last > most || *first > *last) return std::nullopt;
    for (int unit = *first; unit <= *last; ++unit) units.insert(static_cast<std::uint8_t>(unit));
    if (comma == std::string_view::npos) break;
    text.remove_prefix(comma + 1);
  }
  return std::vector<std::uint8_t>(units.begin(), units.end());
}

}  // namespace etcm::bus
