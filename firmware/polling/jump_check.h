// Whether a position of a device can follow the one before it, at the speed that the device has at
// the most.
//
// A device without a sequence number may change its registers while they are read, so that a
// coordinate is half old and half new. Such a position jumps. It is asked for once more before it
// counts: where the second one agrees with it the device was moved, else it never was there. So is
// the first one after the start: nothing is known of where the device was.
#pragma once

#include <cstdint>
#include <optional>

#include "etcm/port/clock.h"
#include "etcm/types.h"

namespace etcm::firmware {

// Of one unit.
class JumpCheck {
 public:
  enum class Verdict : std::uint8_t {
    take,          // it counts
    ask_again,     // it jumps, or is the first: not before the next one agrees
    take_instead,  // it counts, and the one before it that was asked for again does not
    drop,          // neither counts
  };

  // What to do with a position that was read just now. `speed_max` is in units of the mesh a
  // second; a step of a unit each way is no jump, for positions are rounded.
  Verdict judge(Position position, double speed_max, port::Instant now);

 private:
  struct Fix {
    Position position;
    port::Instant at;
  };
  static bool is_jump(const Fix& from, const Fix& to, double speed_max);

  std::optional<Fix> last_;     // that counted
  std::optional<Fix> doubted_;  // that is asked for again
};

}  // namespace etcm::firmware
