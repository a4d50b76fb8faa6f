// 32-bit values in pairs of registers, the high word first (ABCD).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace etcm::firmware {

inline std::uint32_t load_u32(std::span<const std::uint16_t> registers, std::size_t at) {
  return std::uint32_t{registers[at]} << 16 | registers[at + 1];
}

inline void store_u32(std::span<std::uint16_t> registers, std::size_t at, std::uint32_t value) {
  registers[at] = static_cast<std::uint16_t>(value >> 16);
  registers[at + 1] = static_cast<std::uint16_t>(value & 0xffff);
}

}  // namespace etcm::firmware
