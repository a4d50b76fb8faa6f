// How far along a missing subsegment a vertex may stand, where doubles are of no help: the answer
// is exact all the same, and comes.
#include "conforming/feasible_parameter.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <tuple>
#include <utility>

#include "inputs/random.h"
#include "support/exact.h"

namespace etcm::test {
namespace {

// Two vertices so close to the line that every cross product among them is 0 in double.
struct Needle {
  Position from;
  Position to;
  Point right;
  Point left;
  Parameter farthest;
};

constexpr Needle needles[] = {
    {{-1328628, -2657256},
     {1328627, 2657257},
     {-263843285263571, -527686465748815},
     {-315221738506629, -630443430240414},
     25806079},
    {{-6590608, -3295304},
     {6590608, 3295303},
     {1536120472118810, 768059985303076},
     {1096568426168002, 548283995674523},
     226669804},
    {{-2004882, -2004882},
     {2004882, 2004883},
     {-157713910207785, -157713815322524},
     {267301931178874, 267302132059361},
     175496255},
};

TEST(FeasibleParameter, IsFoundInTrianglesWhoseAreaIsNoneInDouble) {
  for (const Needle& needle : needles) {
    SplitSite site;
    site.from = needle.from;
    site.to = needle.to;
    site.head_right = needle.right;
    site.head_left = needle.left;
    EXPECT_EQ(internal::feasible_from_head(site), needle.farthest);
    site.from = needle.to;
    site.to = needle.from;
    site.tail_left = needle.right;
    site.tail_right = needle.left;
    EXPECT_EQ(internal::feasible_from_tail(site), parameter_end - needle.farthest);
  }
}

TEST(FeasibleParameter, IsThatOnTheCircleWhereOneIs) {
  for (const Parameter on_circle : {1, 2, 7, 1000}) {
    SplitSite site;
    site.to = {8, 0};
    // As far on as aside: the circle leaves the line twice as far from the end.
    const std::int64_t half = 4 * std::int64_t{on_circle};
    site.head_right = {half, -half};
    site.head_left = {half, half};
    EXPECT_EQ(internal::feasible_from_head(site), on_circle);
    const Point tail = site.at(site.tail);
    site.tail_left = {tail.x - half, half};
    site.tail_right = {tail.x - half, -half};
    EXPECT_EQ(internal::feasible_from_tail(site), parameter_end - on_circle);
  }
}

// Two points ahead of a vertex, on either side of the line, from near to farther than the line is
// long. Of needles they are some sub-units from it: then doubles tell little of the circle.
std::pair<Point, Point> two_ahead(inputs::Random& random, const Point& end, std::int64_t dx,
                                  std::int64_t dy, bool is_needle) {
  const auto part = [&](std::int64_t length, int digits) {
    return length * random.between(1, 1000) / (std::int64_t{1} << digits);
  };
  const int ahead = random.between(6, 38), aside = random.between(6, 38);
  const auto beside = [&](std::int64_t side) {
    if (is_needle) {
      const std::int64_t length = random.between(1, 1000);
      return Point{end.x + dx / 1024 * length + random.between(-3, 3),
                   end.y + dy / 1024 * length + random.between(-3, 3)};
    }
    return Point{end.x + part(dx, ahead) - side * part(dy, aside),
                 end.y + part(dy, ahead) + side * part(dx, aside)};
  };
  return {beside(-1), beside(1)};
}

TEST(FeasibleParameter, IsTheLastThatIsNotOutsideOfTheCircle) {
  inputs::Random random(7);
  int looked_at = 0, all = 0, none = 0;
  for (int i = 0; i < 20'000; ++i) {
    const bool is_needle = i % 4 == 0;
    const int most = is_needle ? position_max : i % 2 == 0 ? 1000 : 100'000;
    SplitSite site;
    site.from = {random.between(-most, most), random.between(-most, most)};
    site.to = {random.between(-most, most), random.between(-most, most)};
    const int head_at = random.between(0, parameter_end - 1);
    site.head = static_cast<Parameter>(head_at);
    site.tail = static_cast<Parameter>(random.between(head_at + 1, parameter_end));
    const Point head = site.at(site.head), tail = site.at(site.tail);
    std::tie(site.head_right, site.head_left) =
        two_ahead(random, head, tail.x - head.x, tail.y - head.y, is_needle);
    std::tie(site.tail_left, site.tail_right) =
        two_ahead(random, tail, head.x - tail.x, head.y - tail.y, is_needle);
    const auto inside_head = [&](Parameter t) {
      return exact_incircle(head, site.head_right, site.head_left, site.at(t)) >= 0;
    };
    const auto inside_tail = [&](Parameter t) {
      return exact_incircle(tail, site.tail_left, site.tail_right, site.at(t)) >= 0;
    };
    // Those that have an area, and the line between them.
    if (exact_orientation(head, tail, site.head_left) > 0 &&
        exact_orientation(head, tail, site.head_right) < 0 &&
        exact_orientation(head, site.head_right, site.head_left) > 0) {
      const Parameter found = internal::feasible_from_head(site);
      ASSERT_TRUE(found >= site.head && found <= site.tail && inside_head(found)) << i;
      ASSERT_TRUE(found == site.tail || !inside_head(found + 1)) << i;
      ++looked_at;
      all += found == site.tail;
      none += found == site.head;
    }
    if (exact_orientation(tail, head, site.tail_right) > 0 &&
        exact_orientation(tail, head, site.tail_left) < 0 &&
        exact_orientation(tail, site.tail_left, site.tail_right) > 0) {
      const Parameter found = internal::feasible_from_tail(site);
      ASSERT_TRUE(found >= site.head && found <= site.tail && inside_tail(found)) << i;
      ASSERT_TRUE(found == site.head || !inside_tail(found - 1)) << i;
    }
  }
  EXPECT_GT(looked_at, 5'000);
  EXPECT_GT(all, 500);
  EXPECT_GT(looked_at - all - none, looked_at / 4);
  EXPECT_GT(none, 10);
}

}  // namespace
}  // namespace etcm::test
