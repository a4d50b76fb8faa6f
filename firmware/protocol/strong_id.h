// Numbers that keep what they name apart.
#pragma once

#include <compare>
#include <cstdint>
#include <limits>

namespace etcm::firmware {

// 32 bits whatever the width of the ids of the mesh is; all ones name nothing.
template <class Tag>
struct StrongId {
  static constexpr std::uint32_t none_value = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t value = none_value;

  constexpr StrongId() noexcept = default;
  constexpr explicit StrongId(std::uint32_t v) noexcept : value(v) {}
  [[nodiscard]] static constexpr StrongId none() noexcept { return StrongId{}; }
  [[nodiscard]] constexpr bool is_none() const noexcept { return value == none_value; }
  friend constexpr auto operator<=>(const StrongId&, const StrongId&) = default;
};

}  // namespace etcm::firmware
