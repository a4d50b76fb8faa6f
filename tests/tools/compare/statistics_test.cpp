#include "compare/statistics.h"

#include <gtest/gtest.h>

#include <array>

namespace etcm::compare {
namespace {

TEST(Statistics, QuartilesAreInterpolated) {
  const Spread spread = spread_of({4, 1, 3, 2});
  EXPECT_DOUBLE_EQ(spread.lower, 1.75);
  EXPECT_DOUBLE_EQ(spread.median, 2.5);
  EXPECT_DOUBLE_EQ(spread.upper, 3.25);
}

TEST(Statistics, OneValueIsItsOwnSpread) {
  const Spread spread = spread_of({7});
  EXPECT_EQ(spread.lower, 7);
  EXPECT_EQ(spread.upper, 7);
}

TEST(Statistics, PointsOnALineLeaveNoResidual) {
  const std::array<double, 4> x{1, 2, 3, 4};
  const std::array<double, 4> y{5, 7, 9, 11};
  const FittedLine line = fit_line(x, y);
  EXPECT_DOUBLE_EQ(line.slope, 2);
  EXPECT_DOUBLE_EQ(line.offset, 3);
  EXPECT_DOUBLE_EQ(line.r_squared, 1);
  EXPECT_NEAR(line.relative_residual, 0, 1e-12);
}

TEST(Statistics, ACurveIsNoLine) {
  const std::array<double, 5> x{1, 2, 3, 4, 5};
  const std::array<double, 5> y{1, 4, 9, 16, 25};
  const FittedLine line = fit_line(x, y);
  EXPECT_DOUBLE_EQ(line.slope, 6);
  EXPECT_LT(line.r_squared, 0.97);
  EXPECT_GT(line.relative_residual, 0.1);
}

}  // namespace
}  // namespace etcm::compare
