// The time of day, to tell how long a program did not run. It may be wrong, and jump either way.
#pragma once

#include <cstdint>

namespace etcm::port {

class WallClock {
 public:
  // Seconds since the beginning of 1970, UTC.
  virtual std::int64_t seconds() const = 0;

 protected:
  ~WallClock() = default;
};

}  // namespace etcm::port
