#include "circle_search.h"

#include <gtest/gtest.h>

#include <random>
#include <utility>

#include "etcm/predicates.h"

namespace etcm::cli {
namespace {

bool any_inside(const std::vector<Point>& points, const Point& a, const Point& b, const Point& c) {
  for (const Point& point : points) {
    if (incircle(a, b, c, point) > 0) return true;
  }
  return false;
}

// Spread 1 makes grids full of cocircular points; the greatest is all the library allows.
TEST(CircleSearch, AgreesWithAskingEveryPoint) {
  std::mt19937_64 random(7);
  for (const std::int64_t spread : {std::int64_t{4}, std::int64_t{1000}, std::int64_t{1} << 52}) {
    std::uniform_int_distribution<std::int64_t> any(-spread, spread);
    for (int round = 0; round < 60; ++round) {
      std::vector<Point> points(static_cast<std::size_t>(round) * 3);
      for (Point& point : points) point = {any(random), any(random)};
      const CircleSearch search(points);
      for (int i = 0; i < 100; ++i) {
        const Point a{any(random), any(random)};
        Point b{any(random), any(random)};
        // Slivers too: a third corner close to the line through the others.
        Point c = i % 2 == 0 ? Point{any(random), any(random)}
                             : Point{b.x / 2 + a.x / 2 + i % 3, b.y / 2 + a.y / 2};
        const int turn = orient2d(a, b, c);
        if (turn == 0) continue;
        if (turn < 0) std::swap(b, c);
        const auto found = search.inside(a, b, c);
        EXPECT_EQ(found.has_value(), any_inside(points, a, b, c));
        EXPECT_TRUE(!found || incircle(a, b, c, points[*found]) > 0);
      }
    }
  }
}

}  // namespace
}  // namespace etcm::cli
