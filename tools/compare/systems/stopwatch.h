// Time between two steps: on the wall, and of the processor for this process alone, which other
// programs on the machine lengthen less.
#pragma once

#include <time.h>

namespace etcm::compare {

template <clockid_t clock>
class BasicStopwatch {
 public:
  // Microseconds since the last call, or since the start.
  double lap_us() noexcept {
    const timespec now = read();
    const double lap = static_cast<double>(now.tv_sec - last_.tv_sec) * 1e6 +
                       static_cast<double>(now.tv_nsec - last_.tv_nsec) / 1e3;
    last_ = now;
    return lap;
  }

 private:
  static timespec read() noexcept {
    timespec now{};
    clock_gettime(clock, &now);
    return now;
  }
  timespec last_ = read();
};

using WallStopwatch = BasicStopwatch<CLOCK_MONOTONIC>;
using CpuStopwatch = BasicStopwatch<CLOCK_PROCESS_CPUTIME_ID>;

}  // namespace etcm::compare
