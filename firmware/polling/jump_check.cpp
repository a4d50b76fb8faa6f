#include "firmware/polling/jump_check.h"

#include <cmath>
#include <utility>

namespace etcm::firmware {

bool JumpCheck::is_jump(const Fix& from, const Fix& to, double speed_max) {
  constexpr double step_max = 1.5;  // the diagonal of a unit, and more than any rounding of it
  const double x = static_cast<double>(to.position.x) - from.position.x;
  const double y = static_cast<double>(to.position.y) - from.position.y;
  const double seconds = std::chrono::duration<double>(to.at - from.at).count();
  return std::hypot(x, y) > speed_max * seconds + step_max;
}

JumpCheck::Verdict JumpCheck::judge(Position position, double speed_max, port::Instant now) {
  const Fix fix{.position = position, .at = now};
  const std::optional<Fix> doubted = std::exchange(doubted_, std::nullopt);
  const bool jumps = !last_ || is_jump(*last_, fix, speed_max);
  const bool agrees = doubted && !is_jump(*doubted, fix, speed_max);
  if (jumps && !agrees) {
    if (doubted) return Verdict::drop;
    doubted_ = fix;
    return Verdict::ask_again;
  }
  last_ = fix;
  return doubted && !agrees ? Verdict::take_instead : Verdict::take;
}

}  // namespace etcm::firmware
