#include "bench/tiles/emptiness.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "etcm/predicates.h"

namespace etcm::bench {

namespace {

__extension__ using Wide = __int128;

// To the nearest, for a positive divisor.
Wide rounded_quotient(Wide number, Wide divisor) noexcept {
  const Wide twice = 2 * number + divisor;
  const Wide quotient = twice / (2 * divisor);
  return twice < 0 && quotient * (2 * divisor) != twice ? quotient - 1 : quotient;
}

// Beyond every place, and far enough from the ends of its type.
constexpr std::int32_t far_off = std::int32_t{1} << 28;

std::int32_t place_of(Wide value) noexcept {
  return static_cast<std::int32_t>(std::clamp<Wide>(value, -far_off, far_off));
}

}  // namespace

Emptiness Emptiness::disk(Position a, Position b, Position c) noexcept {
  Emptiness made;
  made.is_disk_ = true;
  made.a_ = a;
  made.b_ = b;
  made.c_ = c;
  // Differences are below 2^25, squares of lengths below 2^51, what is summed up below 2^78.
  const std::int64_t bx = b.x - a.x, by = b.y - a.y, cx = c.x - a.x, cy = c.y - a.y;
  const std::int64_t b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
  const Wide divisor = 2 * (Wide{bx} * cy - Wide{by} * cx);
  const Wide x = Wide{b2} * cy - Wide{c2} * by, y = Wide{c2} * bx - Wide{b2} * cx;
  made.middle_ = {.x = place_of(a.x + rounded_quotient(x, divisor)),
                  .y = place_of(a.y + rounded_quotient(y, divisor))};
  const auto dx = static_cast<double>(x) / static_cast<double>(divisor);
  const auto dy = static_cast<double>(y) / static_cast<double>(divisor);
  // Each operation above is right to 2^-53 of its result, and there are few.
  const double radius = std::hypot(dx, dy);
  const double error = 1 + 1e-12 * (radius + std::abs(dx) + std::abs(dy));
  made.box_ = {.left = a.x + dx - radius - error,
               .right = a.x + dx + radius + error,
               .bottom = a.y + dy - radius - error,
               .top = a.y + dy + radius + error};
  return made;
}

Emptiness Emptiness::of(const Mesh& mesh, const Triangle& triangle) noexcept {
  const auto at = [&](std::size_t i) { return mesh.position(triangle.corner[i % 3]); };
  for (std::size_t i = 0; i < 3; ++i) {
    if (triangle.corner[i] == infinite_vertex) return half_plane(at(i + 1), at(i + 2));
  }
  return disk(at(0), at(1), at(2));
}

Emptiness Emptiness::half_plane(Position a, Position b) noexcept {
  Emptiness made;
  made.a_ = a;
  made.b_ = b;
  constexpr double all = std::numeric_limits<double>::infinity();
  made.box_ = {.left = -all, .right = all, .bottom = -all, .top = all};
  return made;
}

bool Emptiness::meets(const Square& square) const noexcept {
  const Position low = square.low, high = square.high;
  if (is_disk_) {
    const bool is_beside =
        box_.right < low.x || box_.left > high.x || box_.top < low.y || box_.bottom > high.y;
    if (is_beside) return false;
    // The nearest place to the middle: rows and columns can be chosen by themselves.
    const Position nearest = {.x = std::clamp(middle_.x, low.x, high.x),
                              .y = std::clamp(middle_.y, low.y, high.y)};
    return incircle(to_point(a_), to_point(b_), to_point(c_), to_point(nearest)) >= 0;
  }
  // The corner that is farthest to the left of the line, or one of two.
  const Position farthest = {.x = b_.y > a_.y ? low.x : high.x, .y = b_.x > a_.x ? high.y : low.y};
  const int side = orient2d(to_point(a_), to_point(b_), to_point(farthest));
  if (side != 0) return side > 0;
  // What is on the line is that corner, or a side along it; is any of it between the ends?
  const auto [left, right] = std::minmax(a_.x, b_.x);
  const auto [bottom, top] = std::minmax(a_.y, b_.y);
  const bool is_level = a_.y == b_.y, is_upright = a_.x == b_.x;
  return (is_level ? low.x <= right && high.x >= left
                   : farthest.x >= left && farthest.x <= right) &&
         (is_upright ? low.y <= top && high.y >= bottom
                     : farthest.y >= bottom && farthest.y <= top);
}

}  // namespace etcm::bench
