// Registers as the numbers a person means: kinds of values, and the order of their words.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/protocol/node_registers.h"

namespace etcm::bus {

enum class ValueKind : std::uint8_t { u16, i16, u32, i32, hex, real };

struct ValueType {
  ValueKind kind = ValueKind::u16;
  firmware::WordOrder order = firmware::WordOrder::abcd;

  std::size_t register_count() const;  // of one value
};

// "u16", "i16", "u32", "i32", "hex", "float"; also "int16" and "int" as mbpoll has them.
std::optional<ValueKind> parse_value_kind(std::string_view text);
// "ABCD", "BADC", "CDAB", "DCBA".
std::optional<firmware::WordOrder> parse_word_order(std::string_view text);

// One value of register_count() registers.
std::string format_value(std::span<const std::uint16_t> registers, ValueType type);

// Appends the registers of one value, which may be written as 0x.. too, to `registers`. False where
// the text is no such value or does not fit; nothing is appended then.
bool parse_value(std::string_view text, ValueType type, std::vector<std::uint16_t>& registers);

// "1:10", "1-10", "1,5,9": units, in ascending order, each once. Nothing where it is no such list,
// or a unit is not in `least` ... 247.
std::optional<std::vector<std::uint8_t>> parse_unit_list(std::string_view text, int least);

}  // namespace etcm::bus
