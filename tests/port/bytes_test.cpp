// ByteReader and what puts the bytes: every width, both ends, and what is cut off.
#include "etcm/port/bytes.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

namespace etcm::port {
namespace {

template <class Number>
void expect_back(Number number) {
  std::vector<std::byte> bytes;
  put_number(bytes, number);
  ASSERT_EQ(bytes.size(), sizeof number);
  ByteReader reader(bytes);
  EXPECT_EQ(reader.take<Number>(), number);
  EXPECT_EQ(reader.left(), 0u);
  EXPECT_FALSE(reader.is_cut_off());
}

template <class Number>
void expect_ends_back() {
  expect_back(std::numeric_limits<Number>::min());
  expect_back(std::numeric_limits<Number>::max());
  expect_back(static_cast<Number>(-1));
  expect_back(Number{0});
  expect_back(Number{1});
}

TEST(Bytes, EachNumberComesBackAsItWas) {
  expect_ends_back<std::uint8_t>();
  expect_ends_back<std::uint16_t>();
  expect_ends_back<std::uint32_t>();
  expect_ends_back<std::uint64_t>();
  expect_ends_back<std::int8_t>();
  expect_ends_back<std::int16_t>();
  expect_ends_back<std::int32_t>();
  expect_ends_back<std::int64_t>();
}

TEST(Bytes, TheLeastByteOfANumberComesFirst) {
  std::vector<std::byte> bytes;
  put_number(bytes, std::uint32_t{0x04030201});
  put_number(bytes, std::int16_t{-2});
  put_text(bytes, std::string_view("a\0\xff", 3));
  EXPECT_EQ(text_of(bytes), std::string_view("\1\2\3\4\xfe\xff"
                                             "a\0\xff",
                                             9));
}

TEST(Bytes, WhatIsCutOffIsNothingAndStaysSo) {
  std::vector<std::byte> bytes;
  put_number(bytes, std::uint32_t{0xffffffff});
  put_text(bytes, "abc");
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    ByteReader reader{std::span(bytes).first(size)};
    const auto number = reader.take<std::uint32_t>();
    EXPECT_EQ(number, size < 4 ? 0u : 0xffffffffu) << size;
    EXPECT_EQ(reader.is_cut_off(), size < 4) << size;
    EXPECT_EQ(reader.take_text(3), "") << size;
    EXPECT_TRUE(reader.is_cut_off()) << size;
    EXPECT_EQ(reader.take<std::uint8_t>(), 0u) << "not even what would fit";
    EXPECT_EQ(reader.left(), 0u);
  }
}

TEST(Bytes, NoSizeIsTooGreatToBeAskedFor) {
  std::vector<std::byte> bytes;
  put_text(bytes, "abcdef");
  ByteReader reader(bytes);
  EXPECT_TRUE(reader.has(3, 2));
  EXPECT_FALSE(reader.has(4, 2));
  EXPECT_FALSE(reader.has(std::numeric_limits<std::uint64_t>::max(), 2));
  EXPECT_TRUE(reader.take_bytes(std::numeric_limits<std::size_t>::max()).empty());
  EXPECT_TRUE(reader.is_cut_off());
  EXPECT_EQ(ByteReader().take_text(0), "");
  EXPECT_FALSE(ByteReader().is_cut_off());
}

}  // namespace
}  // namespace etcm::port
