// The root that machines without a unit for doubles compute is the one that others have.
#include "geometry/root.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "inputs/random.h"

namespace etcm::internal {
namespace {

void expect_rounded(double square) {
  ASSERT_EQ(root_by_digits(square), std::sqrt(square)) << std::hexfloat << square;
  ASSERT_EQ(root(square), std::sqrt(square)) << std::hexfloat << square;
}

TEST(Root, IsCorrectlyRounded) {
  inputs::Random random(1);
  for (int i = 0; i < 200'000; ++i) {
    const double mantissa = 1 + static_cast<double>(random.below(1ull << 52)) * 0x1p-52;
    expect_rounded(std::ldexp(mantissa, static_cast<int>(random.below(2046)) - 1022));
  }
  for (int i = 0; i < 20'000; ++i) {
    const auto side = static_cast<double>(random.below(1ull << 26) + 1);
    for (const double square : {side * side, std::nextafter(side * side, 0.0),
                                std::nextafter(side * side, 1e300), side * side + side}) {
      expect_rounded(square);
    }
  }
}

TEST(Root, HoldsAtTheEnds) {
  expect_rounded(0);
  expect_rounded(std::numeric_limits<double>::min());
  expect_rounded(std::numeric_limits<double>::max());
  expect_rounded(1);
  expect_rounded(std::nextafter(1.0, 0.0));
  expect_rounded(std::nextafter(4.0, 0.0));
}

}  // namespace
}  // namespace etcm::internal
