#include "etcm/files/decimal.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "etcm/types.h"

namespace etcm::files {
namespace {

Decimal decimal(const char* text) {
  const auto value = Decimal::parse(text);
  EXPECT_TRUE(value) << text;
  return value.value_or(Decimal{});
}

TEST(Decimal, ReadsEveryLegalForm) {
  const std::pair<const char*, const char*> table[] = {{"0", "0"},
                                                       {"-0", "0"},
                                                       {"+7", "7"},
                                                       {"007", "7"},
                                                       {".5", "0.5"},
                                                       {"3.", "3"},
                                                       {"-1.250", "-1.25"},
                                                       {"1e3", "1000"},
                                                       {"1E+3", "1000"},
                                                       {"12.5e-1", "1.25"},
                                                       {"0e999999999999", "0"},
                                                       {"1e41", "1e41"},
                                                       {"5e-50", "5e-50"},
                                                       {"1e99999999999999999999", "1e1000000000"}};
  for (const auto& [text, expected] : table) EXPECT_EQ(decimal(text).to_string(), expected) << text;
}

TEST(Decimal, RefusesEverythingElse) {
  for (const char* text : {"", "+", "-", ".", "e5", "1e", "1e+", "1.2.3", "0x10", "inf", "nan",
                           "1 2", "--1", "1,5", "1_000", "1e5.5", "\xC2\xB2"}) {
    EXPECT_FALSE(Decimal::parse(text)) << text;
  }
  EXPECT_FALSE(Decimal::parse(std::string(1001, '1')));
  EXPECT_TRUE(Decimal::parse(std::string(1000, '1')));
}

TEST(Decimal, MultipliesExactly) {
  EXPECT_EQ(decimal("0.1") * decimal("10"), decimal("1"));
  EXPECT_EQ(decimal("-0.125") * decimal("8"), decimal("-1"));
  EXPECT_EQ(decimal("99999999999999999999") * decimal("99999999999999999999"),
            decimal("9999999999999999999800000000000000000001"));
  EXPECT_EQ(decimal("0") * decimal("-5"), Decimal{});
}

TEST(Decimal, ReadsBackWhateverItsExponentIs) {
  for (const char* const text :
       {"44e9613841964", "4400e9613841964", "0.0044e-9613841964", "4400e-9613841964", "0e99"}) {
    const auto number = Decimal::parse(text);
    ASSERT_TRUE(number) << text;
    EXPECT_EQ(Decimal::parse(number->to_string()), number) << text;
  }
}

TEST(Decimal, KnowsItsIntegers) {
  EXPECT_EQ(decimal("1e3").to_integer(), 1000);
  EXPECT_EQ(decimal("9223372036854775807").to_integer(), std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(decimal("-9223372036854775808").to_integer(), std::numeric_limits<std::int64_t>::min());
  EXPECT_FALSE(decimal("9223372036854775808").to_integer());
  EXPECT_FALSE(decimal("1e1000000").to_integer());
  EXPECT_FALSE(decimal("0.5").to_integer());
}

TEST(Decimal, RoundsHalvesAwayFromZero) {
  const std::pair<const char*, const char*> table[] = {
      {"0.5", "1"},    {"-0.5", "-1"}, {"0.4999999999999999999999", "0"},
      {"99.5", "100"}, {"1e-9", "0"},  {"0.05", "0"},
      {"-2.49", "-2"}, {"7", "7"},     {"1e50", "1e50"}};
  for (const auto& [text, expected] : table) {
    EXPECT_EQ(decimal(text).rounded().to_string(), expected) << text;
  }
}

TEST(Coordinate, IsWrittenWithEveryDigitAndReadsBack) {
  EXPECT_EQ(coordinate_text(1), "0.0000000037252902984619140625");
  EXPECT_EQ(coordinate_text(-subunits_per_unit / 2), "-0.5");
  EXPECT_EQ(coordinate_text(position_max * subunits_per_unit), "16777216");
  std::mt19937_64 random(1);
  constexpr std::int64_t most = position_max * subunits_per_unit;
  std::uniform_int_distribution<std::int64_t> any(-most, most);
  for (int i = 0; i < 20000; ++i) {
    const std::int64_t subunits = any(random);
    const Decimal back = decimal(coordinate_text(subunits).c_str());
    EXPECT_EQ((back * Decimal::of(subunits_per_unit)).to_integer(), subunits);
    EXPECT_EQ(back.to_double() * static_cast<double>(subunits_per_unit),
              static_cast<double>(subunits));
  }
}

}  // namespace
}  // namespace etcm::files
