// What the log has told about a unit that answers too late.
#pragma once

#include <algorithm>
#include <optional>

#include "etcm/port/clock.h"

namespace etcm::port {

// Told again where the unit is slower than the timeout that was named, and each repeat_interval
// while it goes on.
class LateAdvice {
 public:
  static constexpr Duration repeat_interval = std::chrono::hours(1);

  // An answer came so late. The timeout to name, or none where nothing is to be told.
  std::optional<Duration> advise(Duration lateness, Instant now) {
    if (lateness <= timeout_ && now < again_at_) return std::nullopt;
    // A quarter more, as it will not always be the same.
    constexpr Duration step = std::chrono::milliseconds(100);
    const Duration enough = (lateness + lateness / 4 + step - Duration(1)) / step * step;
    timeout_ = std::max(timeout_, enough);
    again_at_ = now + repeat_interval;
    return timeout_;
  }

 private:
  Duration timeout_{};
  Instant again_at_{};
};

}  // namespace etcm::port
