// orient2d and incircle against an oracle, stage against stage, and the laws they must obey.
#include "etcm/predicates.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <ostream>
#include <tuple>
#include <vector>

#include "geometry/narrow_filter.h"
#include "geometry/predicates_inline.h"
#include "geometry/predicates_internal.h"
#include "predicate_cases.h"
#include "support/exact.h"

namespace etcm {
void PrintTo(const Point& p, std::ostream* out) { *out << "{" << p.x << ", " << p.y << "}"; }
}  // namespace etcm

namespace {

using etcm::incircle;
using etcm::orient2d;
using etcm::Point;
using etcm::test::Family;
using etcm::test::FourPoints;
using namespace etcm::internal;

constexpr int cases_per_family = 120'000 / etcm::test::thinning;
constexpr std::uint64_t seed = 0x45544341;

class EveryFamily : public testing::TestWithParam<Family> {};

INSTANTIATE_TEST_SUITE_P(Predicates, EveryFamily, testing::ValuesIn(etcm::test::families()),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_P(EveryFamily, Orient2dIsTheOraclesInEveryStage) {
  etcm::test::Random random(seed);
  for (int i = 0; i < cases_per_family; ++i) {
    const auto [a, b, c, unused] = GetParam().make(random);
    const int expected = etcm::test::exact_orientation(a, b, c);
    ASSERT_EQ(orient2d(a, b, c), expected) << testing::PrintToString(std::tie(a, b, c));
    ASSERT_EQ(orient2d_exact<LimbArithmetic>(a, b, c), expected);
#ifdef __SIZEOF_INT128__
    ASSERT_EQ(orient2d_exact<NativeArithmetic>(a, b, c), expected);
#endif
    const int filtered = orient2d_filter(a, b, c);
    ASSERT_TRUE(filtered == 0 || filtered == expected)
        << "the filter lies: " << testing::PrintToString(std::tie(a, b, c));
    const int narrow = orient2d_narrow(a, b, c);
    ASSERT_TRUE(narrow == undecided || narrow == expected)
        << "the narrow filter lies: " << testing::PrintToString(std::tie(a, b, c));
  }
}

TEST_P(EveryFamily, IncircleIsTheOraclesInEveryStage) {
  etcm::test::Random random(seed + 1);
  for (int i = 0; i < cases_per_family; ++i) {
    const FourPoints four = GetParam().make(random);
    const auto& [a, b, c, d] = four;
    const int expected = etcm::test::exact_incircle(a, b, c, d);
    ASSERT_EQ(incircle(a, b, c, d), expected) << testing::PrintToString(four);
    ASSERT_EQ(incircle_exact<LimbArithmetic>(a, b, c, d), expected);
#ifdef __SIZEOF_INT128__
    ASSERT_EQ(incircle_exact<NativeArithmetic>(a, b, c, d), expected);
#endif
    const int filtered = incircle_filter(a, b, c, d);
    ASSERT_TRUE(filtered == 0 || filtered == expected)
        << "the filter lies: " << testing::PrintToString(four);
    const int narrow = incircle_narrow(a, b, c, d);
    ASSERT_TRUE(narrow == undecided || narrow == expected)
        << "the narrow filter lies: " << testing::PrintToString(four);
  }
}

TEST_P(EveryFamily, SignsFollowThePermutationOfTheArguments) {
  etcm::test::Random random(seed + 2);
  for (int i = 0; i < cases_per_family / 4; ++i) {
    const FourPoints four = GetParam().make(random);
    const auto& [a, b, c, d] = four;
    const int turn = orient2d(a, b, c);
    ASSERT_EQ(orient2d(b, c, a), turn) << testing::PrintToString(four);
    ASSERT_EQ(orient2d(c, a, b), turn) << testing::PrintToString(four);
    ASSERT_EQ(orient2d(b, a, c), -turn) << testing::PrintToString(four);
    ASSERT_EQ(orient2d(a, c, b), -turn) << testing::PrintToString(four);
    ASSERT_EQ(orient2d(c, b, a), -turn) << testing::PrintToString(four);
    ASSERT_EQ(orient2d(a, a, b), 0);
    // Every permutation is a product of these exchanges of neighbours.
    const int side = incircle(a, b, c, d);
    ASSERT_EQ(incircle(b, a, c, d), -side) << testing::PrintToString(four);
    ASSERT_EQ(incircle(a, c, b, d), -side) << testing::PrintToString(four);
    ASSERT_EQ(incircle(a, b, d, c), -side) << testing::PrintToString(four);
    ASSERT_EQ(incircle(a, b, c, a), 0);
  }
}

enum class Stage { filter, exact };

struct Orient2dCase {
  const char* name;
  Point a, b, c;
  int sign;
  Stage stage;
};

constexpr std::int64_t far = etcm::test::coordinate_max;

// The sign, and which stage must find it: a filter that gives up early is a fault as well.
constexpr Orient2dCase orient2d_table[] = {
    {"unit_triangle", {0, 0}, {1, 0}, {0, 1}, 1, Stage::filter},
    {"unit_triangle_clockwise", {0, 0}, {0, 1}, {1, 0}, -1, Stage::filter},
    {"whole_box", {-far, -far}, {far, -far}, {far, far}, 1, Stage::filter},
    {"diagonal", {-far, -far}, {far, far}, {0, 0}, 0, Stage::exact},
    {"one_subunit_left_of_the_diagonal", {-far, -far}, {far, far}, {0, 1}, 1, Stage::filter},
    {"one_subunit_right_near_the_end",
     {-far, -far},
     {far, far - 1},
     {far - 2, far - 3},
     -1,
     Stage::exact},
    {"products_equal_in_double",
     {far, far - 1},
     {far - 1, far - 2},
     {-far, -far},
     -1,
     Stage::exact},
    {"one_point", {far, -far}, {far, -far}, {far, -far}, 0, Stage::exact},
};

TEST(Orient2d, EachCaseIsDecidedByItsStage) {
  for (const auto& [name, a, b, c, sign, stage] : orient2d_table) {
    EXPECT_EQ(orient2d(a, b, c), sign) << name;
    EXPECT_EQ(orient2d_filter(a, b, c), has_double_unit && stage == Stage::filter ? sign : 0)
        << name;
  }
}

struct IncircleCase {
  const char* name;
  FourPoints four;
  int sign;
  Stage stage;
};

constexpr IncircleCase incircle_table[] = {
    {"centre_of_the_box", {{{far, far}, {-far, far}, {-far, -far}, {0, 0}}}, 1, Stage::filter},
    {"fourth_corner", {{{far, far}, {-far, far}, {-far, -far}, {far, -far}}}, 0, Stage::exact},
    {"one_subunit_inside_the_fourth_corner",
     {{{far, far}, {-far, far}, {-far, -far}, {far - 1, -far}}},
     1,
     Stage::exact},
    {"clockwise_exchanges_the_sign",
     {{{-far, far}, {far, far}, {-far, -far}, {0, 0}}},
     -1,
     Stage::filter},
    {"outside_a_small_circle", {{{0, 0}, {2, 0}, {0, 2}, {3, 3}}}, -1, Stage::filter},
    {"inside_a_small_circle", {{{0, 0}, {2, 0}, {0, 2}, {1, 1}}}, 1, Stage::filter},
    {"on_a_small_circle", {{{0, 0}, {2, 0}, {0, 2}, {2, 2}}}, 0, Stage::exact},
    {"left_of_a_flat_triangle", {{{0, 0}, {2, 0}, {1, 0}, {1, 1}}}, -1, Stage::filter},
    {"right_of_a_flat_triangle", {{{0, 0}, {2, 0}, {1, 0}, {1, -1}}}, 1, Stage::filter},
    {"all_on_a_line", {{{-far, -far}, {0, 0}, {far, far}, {7, 7}}}, 0, Stage::exact},
};

TEST(Incircle, EachCaseIsDecidedByItsStage) {
  for (const auto& [name, four, sign, stage] : incircle_table) {
    const auto& [a, b, c, d] = four;
    EXPECT_EQ(incircle(a, b, c, d), sign) << name;
    EXPECT_EQ(incircle_filter(a, b, c, d), has_double_unit && stage == Stage::filter ? sign : 0)
        << name;
  }
}

TEST(Filters, DecideNearlyAllOfRandomInput) {
  if (!has_double_unit) GTEST_SKIP() << "they decide nothing here";
  etcm::test::Random random(seed + 3);
  constexpr int count = 100'000;
  int undecided_turns = 0;
  int undecided_sides = 0;
  int coarsely_undecided_sides = 0;
  for (int i = 0; i < count; ++i) {
    FourPoints four;
    for (Point& p : four) p = random.point(etcm::test::coordinate_max);
    undecided_turns += orient2d_filter(four[0], four[1], four[2]) == 0;
    undecided_sides += incircle_filter(four[0], four[1], four[2], four[3]) == 0;
    const Offset a = offset(four[0], four[3]), b = offset(four[1], four[3]),
                 c = offset(four[2], four[3]);
    coarsely_undecided_sides += incircle_coarse(lift(a), cross_value(b, c), lift(b),
                                                cross_value(c, a), lift(c), cross_value(a, b)) == 0;
  }
  EXPECT_LT(undecided_turns, count / 1000);
  EXPECT_LT(undecided_sides, count / 1000);
  EXPECT_LT(coarsely_undecided_sides, count / 1000);
}

TEST(NarrowFilters, DecideNearlyAllOfRandomInput) {
  etcm::test::Random random(seed + 4);
  constexpr int count = 100'000;
  for (const std::int64_t most : {etcm::test::coordinate_max, std::int64_t{1} << 40}) {
    int undecided_turns = 0;
    int undecided_sides = 0;
    for (int i = 0; i < count; ++i) {
      FourPoints four;
      for (Point& p : four) p = random.point(most);
      undecided_turns += orient2d_narrow(four[0], four[1], four[2]) == undecided;
      undecided_sides += incircle_narrow(four[0], four[1], four[2], four[3]) == undecided;
    }
    EXPECT_LT(undecided_turns, count / 1000);
    EXPECT_LT(undecided_sides, count / 1000);
  }
}

// Nodes alone, ties too: those of a grid are on circles and lines all the time.
TEST(NarrowFilters, LeaveNothingOfNearNodesUndecided) {
  etcm::test::Random random(seed + 5);
  constexpr std::int32_t unit_max = 1 << (short_bits - 1);
  for (int i = 0; i < 100'000; ++i) {
    const std::int32_t most = i % 2 == 0 ? 3 : unit_max - 1;
    const auto node = [&] {
      return etcm::to_point({static_cast<std::int32_t>(random.between(-most, most)),
                             static_cast<std::int32_t>(random.between(-most, most))});
    };
    const Point a = node(), b = node(), c = node(), d = node();
    ASSERT_EQ(orient2d_narrow(a, b, c), etcm::test::exact_orientation(a, b, c));
    ASSERT_EQ(incircle_narrow(a, b, c, d), etcm::test::exact_incircle(a, b, c, d));
  }
}

void expect_no_lie(const Point& a, const Point& b, const Point& c, const Point& d) {
  const int side = incircle_narrow(a, b, c, d);
  ASSERT_TRUE(side == undecided || side == etcm::test::exact_incircle(a, b, c, d))
      << testing::PrintToString(std::tie(a, b, c, d));
}

// As long as the short stage takes, and a step longer: its products must fit there, too.
TEST(NarrowFilters, NeverLieWhereShortDifferencesEnd) {
  constexpr std::int32_t most = 1 << (short_bits - 1);
  constexpr std::array places{-2 * most, -most, 1 - most, 0, most, 2 * most};
  std::vector<Point> points;
  for (const std::int32_t x : places) {
    for (const std::int32_t y : places) points.push_back(etcm::to_point({x, y}));
  }
  for (const Point& d : {points.front(), points[7], points[28], points.back()}) {
    for (const Point& a : points) {
      for (const Point& b : points) {
        for (const Point& c : points) {
          ASSERT_NO_FATAL_FAILURE(expect_no_lie(a, b, c, d));
        }
      }
    }
  }
}

// What is short on one axis is not short.
TEST(NarrowFilters, NeverLieOfNodesFarOnOneAxis) {
  etcm::test::Random random(seed + 9);
  for (int i = 0; i < 20'000; ++i) {
    const auto node = [&] {
      const auto short_one = static_cast<std::int32_t>(random.between(-100, 100));
      const auto long_one = static_cast<std::int32_t>(random.between(-1 << 22, 1 << 22));
      return etcm::to_point(i % 2 == 0 ? etcm::Position{short_one, long_one}
                                       : etcm::Position{long_one, short_one});
    };
    const Point a = node(), b = node(), c = node(), d = node();
    ASSERT_NO_FATAL_FAILURE(expect_no_lie(a, b, c, d));
  }
}

// Nodes on a circle, of which one is a Steiner vertex a little beside it: in units it would be on.
TEST(NarrowFilters, NeverTakeASteinerVertexForANode) {
  etcm::test::Random random(seed + 8);
  for (int i = 0; i < 20'000; ++i) {
    const auto left = random.between(-100, 0), right = random.between(1, 100);
    const auto low = random.between(-100, 0), high = random.between(1, 100);
    const auto node = [](std::int64_t x, std::int64_t y) {
      return etcm::to_point({static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)});
    };
    std::array<Point, 4> four{node(left, low), node(right, low), node(right, high),
                              node(left, high)};
    Point& beside = four[static_cast<std::size_t>(i % 4)];
    (i / 4 % 2 == 0 ? beside.x : beside.y) += i / 8 % 2 == 0
                                                  ? etcm::subunits_per_unit / 2
                                                  : random.between(1, etcm::subunits_per_unit - 1);
    const auto [a, b, c, d] = four;
    ASSERT_NO_FATAL_FAILURE(expect_no_lie(a, b, c, d));
  }
}

// As a machine without longer products computes them.
TEST(NarrowFilters, SplitAProductIntoThoseOf32Bits) {
  etcm::test::Random random(seed + 7);
  constexpr std::int32_t most = std::int32_t{1} << narrow_bits;
  for (int i = 0; i < 100'000; ++i) {
    const std::int32_t size = std::int32_t{1} << (i % (narrow_bits + 1));
    const auto a = static_cast<std::int32_t>(random.between(-size, size));
    const auto b = static_cast<std::int32_t>(random.between(-most, most));
    ASSERT_EQ(split_product(a, b), std::int64_t{a} * b) << a << " * " << b;
  }
  for (const std::int32_t a : {-most, -65'536, -65'535, -1, 0, 1, 65'535, 65'536, most - 1, most}) {
    ASSERT_EQ(split_product(a, -most), std::int64_t{a} * -most) << a;
    ASSERT_EQ(split_product(a, most - 1), std::int64_t{a} * (most - 1)) << a;
  }
}

// Each number of bits that is shifted out, and points that are nearly on a line or a circle.
TEST(NarrowFilters, NeverLieNearADegeneracyAtAnyScale) {
  etcm::test::Random random(seed + 6);
  for (int bits = 1; bits <= 52; ++bits) {
    const std::int64_t most = std::int64_t{1} << bits;
    for (int i = 0; i < 20'000 / etcm::test::thinning; ++i) {
      const std::int64_t noise = std::int64_t{1} << random.between(0, bits / 2);
      const auto near = [&](std::int64_t value) {
        return std::clamp(value + random.between(-noise, noise), -most, most);
      };
      // A rectangle's corners are on a circle.
      const Point a = random.point(most), c = random.point(most);
      const Point b{near(c.x), near(a.y)}, d{near(a.x), near(c.y)};
      const int side = incircle_narrow(a, b, c, d);
      ASSERT_TRUE(side == undecided || side == etcm::test::exact_incircle(a, b, c, d))
          << testing::PrintToString(std::tie(a, b, c, d));
      const Point middle{near(a.x / 2 + c.x / 2), near(a.y / 2 + c.y / 2)};
      const int turn = orient2d_narrow(a, c, middle);
      ASSERT_TRUE(turn == undecided || turn == etcm::test::exact_orientation(a, c, middle))
          << testing::PrintToString(std::tie(a, c, middle));
    }
  }
}

}  // namespace
