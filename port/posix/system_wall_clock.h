// The system's time of day.
#pragma once

#include <chrono>

#include "etcm/port/wall_clock.h"

namespace etcm::port {

class SystemWallClock final : public WallClock {
 public:
  std::int64_t milliseconds() const override {
    return std::chrono::duration_cast<std::chrono::milliseconds>(
               std::chrono::system_clock::now().time_since_epoch())
        .count();
  }
};

}  // namespace etcm::port
