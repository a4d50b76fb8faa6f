// Numbers and unit lists as a person types them.
#include "values.h"

#include <gtest/gtest.h>

#include <limits>

namespace etcm::bus {
namespace {

using firmware::WordOrder;
using Registers = std::vector<std::uint16_t>;

ValueType type_of(ValueKind kind, WordOrder order = WordOrder::abcd) { return {kind, order}; }

struct Written {
  const char* name;
  const char* text;
  ValueType type;
  Registers registers;
};
void PrintTo(const Written& row, std::ostream* out) { *out << row.name; }
class Value : public ::testing::TestWithParam<Written> {};

TEST_P(Value, IsWrittenAndReadInItsOrder) {
  Registers registers;
  ASSERT_TRUE(parse_value(GetParam().text, GetParam().type, registers));
  EXPECT_EQ(registers, GetParam().registers);
  EXPECT_EQ(format_value(registers, GetParam().type), GetParam().text);
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, Value,
    ::testing::Values(
        Written{"U16", "65535", type_of(ValueKind::u16), {0xffff}},
        Written{"I16", "-2", type_of(ValueKind::i16), {0xfffe}},
        Written{"Hex", "0x0A5F", type_of(ValueKind::hex), {0x0a5f}},
        Written{"U32", "4276993246", type_of(ValueKind::u32), {0xfeed, 0xbcde}},
        Written{"I32", "-2147483648", type_of(ValueKind::i32), {0x8000, 0}},
        Written{"Float", "-1.5", type_of(ValueKind::real), {0xbfc0, 0}},
        Written{"Badc", "16909060", type_of(ValueKind::u32, WordOrder::badc), {0x0201, 0x0403}},
        Written{"Cdab", "16909060", type_of(ValueKind::u32, WordOrder::cdab), {0x0304, 0x0102}},
        Written{"Dcba", "16909060", type_of(ValueKind::u32, WordOrder::dcba), {0x0403, 0x0201}},
        Written{"SwappedBytes", "258", type_of(ValueKind::u16, WordOrder::dcba), {0x0201}}),
    [](const auto& row) { return row.param.name; });

TEST(Values, WhatDoesNotFitIsRefusedAndAddsNothing) {
  const std::pair<const char*, ValueKind> rows[] = {
      {"", ValueKind::u16},           {"-1", ValueKind::u16},
      {"65536", ValueKind::u16},      {"0x10000", ValueKind::hex},
      {"0x", ValueKind::hex},         {"32768", ValueKind::i16},
      {"-32769", ValueKind::i16},     {"4294967296", ValueKind::u32},
      {"2147483648", ValueKind::i32}, {"99999999999999999999", ValueKind::u32},
      {"1.5", ValueKind::u16},        {"1 ", ValueKind::u16},
      {"one", ValueKind::real},       {"1e99", ValueKind::real},
  };
  Registers registers{7};
  for (const auto& [text, kind] : rows) {
    EXPECT_FALSE(parse_value(text, type_of(kind), registers)) << text;
  }
  EXPECT_EQ(registers, Registers{7});
}

TEST(Values, EveryFloatComesBackAsItWas) {
  for (const float value :
       {0.1f, -0.0f, 1e-45f, 3.4028235e38f, std::numeric_limits<float>::infinity()}) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    const Registers sent{static_cast<std::uint16_t>(bits >> 16), static_cast<std::uint16_t>(bits)};
    Registers back;
    ASSERT_TRUE(
        parse_value(format_value(sent, type_of(ValueKind::real)), type_of(ValueKind::real), back));
    EXPECT_EQ(back, sent) << value;
  }
}

TEST(UnitList, IsReadAsMbpollReadsIt) {
  using Units = std::vector<std::uint8_t>;
  EXPECT_EQ(parse_unit_list("3", 1), (Units{3}));
  EXPECT_EQ(parse_unit_list("1:4", 1), (Units{1, 2, 3, 4}));
  EXPECT_EQ(parse_unit_list("9,1-3,2", 1), (Units{1, 2, 3, 9}));
  EXPECT_EQ(parse_unit_list("1:247", 1)->size(), 247u);
  EXPECT_EQ(parse_unit_list("0", 0), (Units{0}));
  for (const char* text :
       {"", "0", "248", "4:1", "1:", ":3", "1,,2", "1,", "a", "-1", "1:2:3", "1 2", "4294967297"}) {
    EXPECT_FALSE(parse_unit_list(text, 1)) << text;
  }
}

}  // namespace
}  // namespace etcm::bus
