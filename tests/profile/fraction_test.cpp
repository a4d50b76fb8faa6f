#include "firmware/profile/fraction.h"

#include <gtest/gtest.h>

namespace etcm::firmware {
namespace {

constexpr std::int64_t int64_most = INT64_MAX;

TEST(Fraction, IsReadExactly) {
  EXPECT_EQ(Fraction::parse("12"), (Fraction{12, 1}));
  EXPECT_EQ(Fraction::parse("-0.001"), (Fraction{-1, 1000}));
  EXPECT_EQ(Fraction::parse("1e-7"), (Fraction{1, 10'000'000}));
  EXPECT_EQ(Fraction::parse("1/60000"), (Fraction{1, 60'000}));
  EXPECT_EQ(Fraction::parse("0.5/-30"), (Fraction{-1, 60}));
  EXPECT_EQ(Fraction::parse("0"), (Fraction{0, 1}));
  EXPECT_EQ(Fraction::parse("0/7"), (Fraction{0, 1}));
  EXPECT_EQ(Fraction::parse("9223372036854775807"), (Fraction{int64_most, 1}));
}

TEST(Fraction, IsNothingElse) {
  for (const char* const text :
       {"", "/", "1/", "/2", "1/0", "1/2/3", "x", "0x10", "1 /2", "nan", "inf", "1e19", "1e-19",
        "9223372036854775808", "-9223372036854775808", "1/1e-18/1e18", "1e18/1e-18"}) {
    EXPECT_FALSE(Fraction::parse(text)) << text;
  }
}

TEST(Fraction, ProductsAreExactOrNothing) {
  EXPECT_EQ(multiply({1, 3}, {3, 1}), (Fraction{1, 1}));
  EXPECT_EQ(multiply({int64_most, 1}, {1, int64_most}), (Fraction{1, 1}));
  EXPECT_EQ(multiply({0, 1}, {1, 7}), (Fraction{0, 1}));
  EXPECT_FALSE(multiply({int64_most, 1}, {2, 1}));
  EXPECT_FALSE(multiply({1, int64_most}, {1, 2}));
}

TEST(Fraction, ScalesToTheNearest) {
  EXPECT_EQ(scaled(1, {1, 2}), 1);
  EXPECT_EQ(scaled(-1, {1, 2}), -1);
  EXPECT_EQ(scaled(-1, {1, 3}), 0);
  EXPECT_EQ(scaled(2, {1, 3}), 1);
  EXPECT_EQ(scaled(int64_most, {1, 1}), int64_most);
  EXPECT_EQ(scaled(INT64_MIN, {1, 2}), -(int64_most / 2) - 1);
  EXPECT_FALSE(scaled(INT64_MIN, {1, 1}));
  EXPECT_FALSE(scaled(INT64_MIN, {-1, 1}));
  EXPECT_FALSE(scaled(int64_most, {3, 2}));
  // The product alone would not fit.
  EXPECT_EQ(scaled(int64_most, {int64_most, int64_most - 1}), std::nullopt);
  EXPECT_EQ(scaled(int64_most - 1, {int64_most, int64_most - 1}), int64_most);
  EXPECT_EQ(scaled(1'000'000'000'000, {123'456'789, 1000}), 123'456'789'000'000'000);
}

TEST(Fraction, SumsThatDoNotFitAreNothing) {
  EXPECT_EQ(add(int64_most - 1, 1), int64_most);
  EXPECT_FALSE(add(int64_most, 1));
  EXPECT_FALSE(add(-int64_most, -1));
}

}  // namespace
}  // namespace etcm::firmware
