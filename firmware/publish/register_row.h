// What the tables of registers are made of.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "firmware/protocol/serial.h"

namespace etcm::firmware {

// One value of a header or of an entry of a list; its offset follows from the rows before it.
template <typename Source>
struct RegisterRow {
  const char* name;
  std::uint16_t registers;  // 1, or 2 with the high word first
  const char* content;      // for the guide; {} stands for a value that is always the same
  std::uint32_t (*value)(const Source&);
  std::uint16_t offset = 0;  // from the start of the block or of the entry
};

// Rows follow each other without a gap.
template <typename Source, std::size_t count>
constexpr std::array<RegisterRow<Source>, count> in_sequence(
    std::array<RegisterRow<Source>, count> rows) {
  std::uint16_t next = 0;
  for (RegisterRow<Source>& row : rows) {
    row.offset = next;
    next = static_cast<std::uint16_t>(next + row.registers);
  }
  return rows;
}

template <typename Source>
constexpr std::uint32_t size_of(std::span<const RegisterRow<Source>> rows) {
  return rows.back().offset + rows.back().registers;
}
template <typename Source>
constexpr bool has_plain_widths(std::span<const RegisterRow<Source>> rows) {
  for (const RegisterRow<Source>& row : rows) {
    if (row.registers != 1 && row.registers != 2) return false;
  }
  return true;
}
// FNV-1a over names and places: what a master's program relies on.
template <typename Source>
constexpr std::uint32_t fingerprint(std::span<const RegisterRow<Source>> rows) {
  std::uint32_t hash = 2166136261u;
  const auto add = [&](std::uint32_t value) { hash = (hash ^ value) * 16777619u; };
  for (const RegisterRow<Source>& row : rows) {
    for (const char letter : std::string_view(row.name)) add(static_cast<unsigned char>(letter));
    add(row.offset);
    add(row.registers);
  }
  return hash;
}

constexpr std::uint32_t register_of(Serial serial) { return serial.is_none() ? 0 : serial.value; }

constexpr std::uint32_t flag(bool is_set, std::uint32_t bits) { return is_set ? bits : 0u; }

}  // namespace etcm::firmware
