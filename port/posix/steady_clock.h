// The system's monotonic clock.
#pragma once

#include "etcm/port/clock.h"

namespace etcm::port {

class SteadyClock final : public Clock {
 public:
  Instant now() const override {
    return Instant{
        std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now().time_since_epoch())};
  }
};

}  // namespace etcm::port
