// The exact stage of the predicates, over either integer arithmetic. For predicates.cpp and tests.
#pragma once

#include <cstddef>

#include "etcm/types.h"
#include "geometry/wide_int.h"

namespace etcm::internal {

// Differences are at most S = 2^53 in magnitude, so the determinant is below 2 S^2 = 2^107.
template <class Arithmetic>
int orient2d_exact(const Point& a, const Point& b, const Point& c) noexcept {
  return Arithmetic::sign(Arithmetic::product(a.x - c.x, b.y - c.y) -
                          Arithmetic::product(a.y - c.y, b.x - c.x));
}

// With differences of at most S = 2^53, a lift is at most 2 S^2 = 2^107 and a cross product too, so
// both fit 128 bits; each of the three terms is at most 2^214 and no partial sum exceeds 2^216.
// The final value is smaller still: it is twice the triangle's area times the power of d, and for
// four points in an S x S box that is at most S^4 / 2 = 2^211.
template <class Arithmetic>
int incircle_exact(const Point& a, const Point& b, const Point& c, const Point& d) noexcept {
  using Int128 = typename Arithmetic::Int128;
  struct Difference {
    std::int64_t x;
    std::int64_t y;
  };
  const auto lift = [](const Difference& p) noexcept -> Int128 {
    return Arithmetic::product(p.x, p.x) + Arithmetic::product(p.y, p.y);
  };
  const auto cross = [](const Difference& p, const Difference& q) noexcept -> Int128 {
    return Arithmetic::product(p.x, q.y) - Arithmetic::product(p.y, q.x);
  };
  const Difference p[] = {{a.x - d.x, a.y - d.y}, {b.x - d.x, b.y - d.y}, {c.x - d.x, c.y - d.y}};
  // One after the other, so that the limbs of one alone are on the stack.
  auto sum = Arithmetic::product(lift(p[0]), cross(p[1], p[2]));
  for (std::size_t i = 1; i < 3; ++i) {
    sum = sum + Arithmetic::product(lift(p[i]), cross(p[(i + 1) % 3], p[(i + 2) % 3]));
  }
  return Arithmetic::sign(sum);
}

}  // namespace etcm::internal
