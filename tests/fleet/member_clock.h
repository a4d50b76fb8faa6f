// The clocks of one gateway, which agree with nobody's: the steady one begins anew with each start
// of the machine and goes too fast or too slow, the time of day may be any or unknown.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "etcm/port/clock.h"
#include "inputs/random.h"

namespace etcm::test {

class MemberClock {
 public:
  static constexpr std::int32_t rate_ppm_max = 1000;

  // The machine starts: the steady clock has run for a moment, or for years. Until then it is that
  // of the simulation, and the time of day is not known.
  void boot(inputs::Random& random, port::Instant time);
  // Somebody sets the time of day.
  void jump(inputs::Random& random);
  // The machine has slept, and its steady clock stood still meanwhile.
  void stand_still(port::Instant from, port::Instant to) { origin_ -= at(to) - at(from); }

  // Both at a time of the simulation, which is no earlier than the last start.
  port::Instant at(port::Instant time) const;
  std::string time_of_day(port::Instant time) const;  // ISO 8601 in UTC; empty: it is not known

 private:
  port::Instant booted_at_{};
  port::Duration origin_{};
  std::int64_t rate_ppm_ = 0;
  std::optional<std::int64_t> day_s_;  // since 1970, when the machine started
};

}  // namespace etcm::test
