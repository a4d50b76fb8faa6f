#include "conforming/feasible_parameter.h"

#include "geometry/predicates_inline.h"

namespace etcm::internal {
namespace {

// Where the line from `end` along (dx, dy) leaves the circle through end, b and c, in multiples of
// (dx, dy). With end as origin the circle's centre o solves 2 o.b = b.b, 2 o.c = c.c, and the
// line leaves at 2 o.d / d.d.
double guess(const Point& end, double dx, double dy, const Point& b, const Point& c) noexcept {
  const auto bx = static_cast<double>(b.x - end.x), by = static_cast<double>(b.y - end.y);
  const auto cx = static_cast<double>(c.x - end.x), cy = static_cast<double>(c.y - end.y);
  const double bb = bx * bx + by * by;
  const double cc = cx * cx + cy * cy;
  const double doubled_area = bx * cy - by * cx;
  return (bb * (dx * cy - dy * cx) + cc * (bx * dy - by * dx)) /
         (doubled_area * (dx * dx + dy * dy));
}

// The largest k in [0, limit] for which inside(k) holds. inside(0) does, and once it does not, it
// never does again. Gallops from the guess, then halves: at most 2 * 29 tests, 2 or 3 where the
// guess is good.
template <class Inside>
Parameter last_inside(double guessed, Parameter limit, Inside inside) noexcept {
  Parameter low = 0;       // inside
  Parameter high = limit;  // the answer is at most this
  // No number: the triangle has no area in double. Then it is galloped from the end.
  Parameter k = guessed >= limit ? limit : guessed > 0 ? static_cast<Parameter>(guessed) : 0;
  Parameter step = 1;
  if (k > 0 && !inside(k)) {
    high = k - 1;
    while (high > low) {
      k = high >= step ? high - step : 0;
      if (k == 0 || inside(k)) {
        low = k;
        break;
      }
      high = k - 1;
      step *= 2;
    }
  } else {
    low = k;
    while (low < high) {
      k = high - low > step ? low + step : high;
      if (!inside(k)) {
        high = k - 1;
        break;
      }
      low = k;
      step *= 2;
    }
  }
  while (low < high) {
    k = low + (high - low + 1) / 2;
    if (inside(k)) {
      low = k;
    } else {
      high = k - 1;
    }
  }
  return low;
}

}  // namespace

Parameter feasible_from_head(const SplitSite& site) noexcept {
  const Point end = site.at(site.head);
  const double dx = static_cast<double>(site.to.x) - site.from.x;
  const double dy = static_cast<double>(site.to.y) - site.from.y;
  const double guessed = guess(end, dx, dy, site.head_right, site.head_left);
  return static_cast<Parameter>(
      site.head + last_inside(guessed, site.tail - site.head, [&](Parameter k) noexcept {
        return incircle_fast(end, site.head_right, site.head_left, site.at(site.head + k)) >= 0;
      }));
}

Parameter feasible_from_tail(const SplitSite& site) noexcept {
  const Point end = site.at(site.tail);
  const double dx = static_cast<double>(site.from.x) - site.to.x;
  const double dy = static_cast<double>(site.from.y) - site.to.y;
  const double guessed = guess(end, dx, dy, site.tail_left, site.tail_right);
  return static_cast<Parameter>(
      site.tail - last_inside(guessed, site.tail - site.head, [&](Parameter k) noexcept {
        return incircle_fast(end, site.tail_left, site.tail_right, site.at(site.tail - k)) >= 0;
      }));
}

}  // namespace etcm::internal
