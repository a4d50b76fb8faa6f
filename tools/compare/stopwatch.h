// Time between two steps.
#pragma once

#include <chrono>

namespace etcm::compare {

class Stopwatch {
 public:
  // Microseconds since the last call, or since the start.
  double lap_us() noexcept {
    const auto now = Clock::now();
    const double lap = std::chrono::duration<double, std::micro>(now - last_).count();
    last_ = now;
    return lap;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
};

}  // namespace etcm::compare
