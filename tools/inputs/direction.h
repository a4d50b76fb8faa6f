// Places at an angle, in integers alone: the sine of a C library differs between machines.
#pragma once

#include <cstdint>

#include "etcm/types.h"

namespace etcm::inputs {

inline constexpr std::int32_t full_turn_millidegrees = 360'000;

// The place `distance` (at most 2^25) from `origin`, counter-clockwise from the x axis, rounded to
// whole units. Any angle.
Position at_angle(Position origin, std::int32_t millidegrees, std::int32_t distance) noexcept;

}  // namespace etcm::inputs
