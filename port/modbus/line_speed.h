// The speed of a serial port, any that its driver takes.
#pragma once

#include <cstdint>
#include <string>

namespace etcm::port {

// A receiver still finds the middle of the last bit of a byte where both sides together are off by
// less than twice this.
inline constexpr std::uint32_t speed_error_percent_max = 2;

// Whether a port that is set to `actual` can be used for `wanted`.
bool is_near(std::uint32_t actual, std::uint32_t wanted);

// Sets the speed, and looks which one the driver made of it. False where that is too far off, with
// the reason and the cure. All other settings stay.
bool set_speed(int descriptor, std::uint32_t baud, std::string& why);

}  // namespace etcm::port
