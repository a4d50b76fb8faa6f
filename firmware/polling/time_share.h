// A part of the time of a bus, for questions that are worth less than those whose turn it is.
#pragma once

#include <algorithm>
#include <cstdint>

#include "etcm/port/clock.h"

namespace etcm::firmware {

// One part in `parts`. What was not used counts for `saved_max` back, at most: then several
// questions may follow at once.
class TimeShare {
 public:
  explicit TimeShare(std::int64_t parts, port::Duration saved_max = {})
      : parts_(parts), saved_max_(saved_max) {}

  // From when on a question may be asked.
  port::Instant free_at() const { return used_up_to_ - saved_max_; }

  // Others had to wait so long for one.
  void charge(port::Duration cost, port::Instant now) {
    // Those asked without regard to the share do not add up.
    const port::Instant from = std::clamp(used_up_to_, now, now + saved_max_);
    used_up_to_ = std::max(used_up_to_, from + cost * (parts_ - 1));
  }

  // A question may be asked at once.
  void open(port::Instant now) { used_up_to_ = std::min(used_up_to_, now); }

 private:
  std::int64_t parts_;
  port::Duration saved_max_;
  port::Instant used_up_to_{};
};

}  // namespace etcm::firmware
