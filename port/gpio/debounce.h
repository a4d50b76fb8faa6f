// A level that counts once it has stood still.
#pragma once

#include "etcm/port/clock.h"

namespace etcm::port {

class Debounce {
 public:
  Debounce(bool level, Duration period) : level_(level), period_(period) {}

  bool level() const { return level_; }

  // The line was read. `moved`: it has changed since the last time, perhaps more than once.
  void sample(bool level, bool moved, Instant now) {
    if (level == level_) {
      settles_at_ = never;
    } else if (settles_at_ == never || moved) {
      settles_at_ = now + period_;
    }
    if (settles_at_ <= now) {
      level_ = level;
      settles_at_ = never;
    }
  }

  // When to read the line again at the latest.
  Instant settles_at() const { return settles_at_; }

 private:
  bool level_;
  Duration period_;
  Instant settles_at_ = never;
};

}  // namespace etcm::port
