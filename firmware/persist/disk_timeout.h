#pragma once

#include "etcm/port/clock.h"

namespace etcm::firmware {

// A disk that has not answered for so long is not slow but broken: the log says so.
inline constexpr port::Duration disk_timeout = std::chrono::seconds(10);

}  // namespace etcm::firmware
