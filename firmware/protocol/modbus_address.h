// Where a unit answers on its bus.
#pragma once

#include <compare>
#include <cstdint>

namespace etcm::firmware {

// 1 to 247; 0, to which nobody answers, is none.
struct ModbusAddress {
  std::uint8_t value = 0;

  constexpr ModbusAddress() noexcept = default;
  constexpr explicit ModbusAddress(std::uint8_t v) noexcept : value(v) {}
  friend constexpr auto operator<=>(const ModbusAddress&, const ModbusAddress&) = default;
};

}  // namespace etcm::firmware
