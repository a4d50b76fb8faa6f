// incircle_perturbed: never a tie, one order, one triangulation.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "etcm/predicates.h"
#include "predicate_cases.h"
#include "support/exact.h"

namespace {

using etcm::incircle;
using etcm::incircle_perturbed;
using etcm::orient2d;
using etcm::Point;
using etcm::test::Family;
using etcm::test::FourPoints;

class Perturbation : public testing::TestWithParam<Family> {};

INSTANTIATE_TEST_SUITE_P(Predicates, Perturbation, testing::ValuesIn(etcm::test::families()),
                         [](const auto& test) { return std::string(test.param.name); });

bool all_distinct(const FourPoints& four) { return std::set(four.begin(), four.end()).size() == 4; }

// A tie-break that is the sign of some determinant changes sign with every exchange of two points,
// like the determinant itself. All 24 orders are tried whose first three points turn left.
TEST_P(Perturbation, IsNeverZeroAndFollowsThePermutation) {
  etcm::test::Random random(1911);
  for (int i = 0; i < 10'000 / etcm::test::thinning; ++i) {
    const FourPoints four = GetParam().make(random);
    if (!all_distinct(four)) continue;
    std::array<std::size_t, 4> order{0, 1, 2, 3};
    int sign_of_identity = 0;
    do {
      const Point &a = four[order[0]], &b = four[order[1]], &c = four[order[2]],
                  &d = four[order[3]];
      if (orient2d(a, b, c) <= 0) continue;
      const int answer = incircle_perturbed(a, b, c, d);
      ASSERT_TRUE(answer == 1 || answer == -1);
      ASSERT_EQ(answer, etcm::test::exact_incircle_perturbed(a, b, c, d));
      if (const int exact = incircle(a, b, c, d); exact != 0) {
        ASSERT_EQ(answer, exact);
      }
      int inversions = 0;
      for (std::size_t j = 0; j < 4; ++j) {
        for (std::size_t k = j + 1; k < 4; ++k) inversions += order[j] > order[k];
      }
      const int sign = inversions % 2 == 0 ? answer : -answer;
      if (sign_of_identity == 0) sign_of_identity = sign;
      ASSERT_EQ(sign, sign_of_identity);
    } while (std::next_permutation(order.begin(), order.end()));
  }
}

std::int64_t twice_area(const Point& a, const Point& b, const Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// `points` sorted lexicographically.
std::int64_t twice_hull_area(const std::vector<Point>& points) {
  std::vector<Point> hull;
  const auto half = [&](auto first, auto last) {
    const std::size_t base = hull.size();
    for (; first != last; ++first) {
      while (hull.size() >= base + 2 && twice_area(hull.end()[-2], hull.back(), *first) <= 0) {
        hull.pop_back();
      }
      hull.push_back(*first);
    }
    hull.pop_back();
  };
  half(points.begin(), points.end());
  half(points.rbegin(), points.rend());
  std::int64_t area = 0;
  for (std::size_t i = 1; i + 1 < hull.size(); ++i) {
    area += twice_area(hull[0], hull[i], hull[i + 1]);
  }
  return area;
}

// Takes every triangle that, by the perturbed predicate, has no other point inside: they must tile
// the convex hull, each edge used once from each side.
void expect_one_triangulation(std::vector<Point> points) {
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  std::map<std::pair<Point, Point>, int> edge_uses;
  std::int64_t area = 0;
  for (const Point& a : points) {
    for (const Point& b : points) {
      for (const Point& c : points) {
        // Each triangle once, from its least corner.
        if (!(a < b && a < c) || orient2d(a, b, c) <= 0) continue;
        const bool empty = std::all_of(points.begin(), points.end(), [&](const Point& d) {
          return d == a || d == b || d == c || incircle_perturbed(a, b, c, d) < 0;
        });
        if (!empty) continue;
        area += twice_area(a, b, c);
        for (const auto& edge : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
          ASSERT_EQ(++edge_uses[edge], 1) << testing::PrintToString(points.size());
        }
      }
    }
  }
  ASSERT_EQ(area, twice_hull_area(points));
}

TEST(PerturbedDelaunay, OfPointsOnOneCircleIsOneTriangulation) {
  // x^2 + y^2 = 65^2 has 36 solutions.
  std::vector<Point> circle;
  for (std::int64_t x = -65; x <= 65; ++x) {
    for (std::int64_t y = -65; y <= 65; ++y) {
      if (x * x + y * y == 65 * 65) circle.push_back({x, y});
    }
  }
  ASSERT_EQ(circle.size(), 36U);
  etcm::test::Random random(7);
  for (int i = 0; i < 2'000; ++i) {
    std::vector<Point> some;
    const std::int64_t count = random.between(4, 8);
    for (std::int64_t j = 0; j < count; ++j) {
      some.push_back(circle[static_cast<std::size_t>(random.between(0, 35))]);
    }
    ASSERT_NO_FATAL_FAILURE(expect_one_triangulation(some));
  }
  ASSERT_NO_FATAL_FAILURE(expect_one_triangulation(circle));
}

TEST(PerturbedDelaunay, OfPointsOnASmallGridIsOneTriangulation) {
  etcm::test::Random random(8);
  for (int i = 0; i < 4'000; ++i) {
    const std::int64_t side = random.between(1, 4);
    std::vector<Point> some;
    const std::int64_t count = random.between(4, 10);
    for (std::int64_t j = 0; j < count; ++j) {
      some.push_back({random.between(0, side), random.between(0, side)});
    }
    if (std::all_of(some.begin(), some.end(),
                    [&](const Point& p) { return orient2d(some[0], some[1], p) == 0; })) {
      continue;
    }
    ASSERT_NO_FATAL_FAILURE(expect_one_triangulation(some));
  }
}

}  // namespace
