// The time of day: how long a program did not run, and when something was measured, for others. It
// may be wrong, and jump either way.
#pragma once

#include <cstdint>

namespace etcm::port {

class WallClock {
 public:
  // Since the beginning of 1970, UTC.
  virtual std::int64_t milliseconds() const = 0;
  std::int64_t seconds() const { return milliseconds() / 1000; }

 protected:
  ~WallClock() = default;
};

}  // namespace etcm::port
