#include "inputs/direction.h"

namespace etcm::inputs {
namespace {

// Fixed point with 30 fraction bits: the error is below 2^-27, so below half a unit at 2^25.
constexpr int fraction_bits = 30;
constexpr std::int64_t one = std::int64_t{1} << fraction_bits;
constexpr std::int64_t pi = 3373259426;  // pi * 2^30

constexpr std::int32_t quarter_turn = full_turn_millidegrees / 4;

std::int64_t multiply(std::int64_t a, std::int64_t b) noexcept { return (a * b) >> fraction_bits; }

// The Taylor series from term x^first / first!, where first is 0 (cosine) or 1 (sine). The angle is
// within an eighth of a turn, so x < 1 and 14 terms are plenty.
std::int64_t series(std::int64_t x, int first) noexcept {
  std::int64_t term = first == 0 ? one : x;
  std::int64_t sum = term;
  for (int power = first + 2; power <= 14; power += 2) {
    term = -multiply(multiply(term, x), x) / (std::int64_t{power} * (power - 1));
    sum += term;
  }
  return sum;
}

struct Direction {
  std::int64_t cosine;
  std::int64_t sine;
};

// 0 <= millidegrees <= quarter_turn.
Direction in_first_quarter(std::int32_t millidegrees) noexcept {
  if (millidegrees > quarter_turn / 2) {
    const Direction mirrored = in_first_quarter(quarter_turn - millidegrees);
    return {mirrored.sine, mirrored.cosine};
  }
  const std::int64_t radians = millidegrees * pi / (full_turn_millidegrees / 2);
  return {series(radians, 0), series(radians, 1)};
}

std::int32_t scaled(std::int64_t ratio, std::int32_t distance) noexcept {
  return static_cast<std::int32_t>((ratio * distance + one / 2) >> fraction_bits);
}

}  // namespace

Position at_angle(Position origin, std::int32_t millidegrees, std::int32_t distance) noexcept {
  std::int32_t angle = millidegrees % full_turn_millidegrees;
  if (angle < 0) angle += full_turn_millidegrees;
  Direction direction = in_first_quarter(angle % quarter_turn);
  for (std::int32_t turned = 0; turned < angle / quarter_turn; ++turned) {
    direction = {-direction.sine, direction.cosine};
  }
  return {origin.x + scaled(direction.cosine, distance),
          origin.y + scaled(direction.sine, distance)};
}

}  // namespace etcm::inputs
