// Time as the gateway sees it: monotonic, in nanoseconds, from an origin of no meaning.
#pragma once

#include <chrono>

namespace etcm::port {

using Duration = std::chrono::nanoseconds;

class Clock;
using Instant = std::chrono::time_point<Clock, Duration>;

class Clock {
 public:
  using rep = Duration::rep;
  using period = Duration::period;
  using duration = Duration;
  static constexpr bool is_steady = true;

  virtual Instant now() const = 0;

 protected:
  ~Clock() = default;
};

// Later than everything: "no deadline".
inline constexpr Instant never = Instant::max();

}  // namespace etcm::port
