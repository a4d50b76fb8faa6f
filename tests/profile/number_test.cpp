// One number in registers, in every type and order.
#include "device.h"

namespace etcm::firmware {
namespace {

using State = FieldValue::State;

std::string text_of(const FieldValue& value) {
  switch (value.state) {
    case State::value:
      return std::to_string(value.nano);
    case State::none:
      return "none";
    case State::malformed:
      return "malformed";
    case State::other_axis:
      return "of the other axis";
    case State::no_letter:
      return "without its letter";
    case State::out_of_range:
      return "out of range";
  }
  return "";
}

struct Case {
  const char* field;
  std::vector<std::uint16_t> registers;
  const char* expected;  // in 10^-9, or what is wrong with it
};

void expect(const std::vector<Case>& cases) {
  for (const Case& each : cases) {
    EXPECT_EQ(text_of(decoded(each.field, each.registers)), each.expected) << each.field;
  }
}

TEST(ProfileNumber, HasEveryTypeOfInteger) {
  expect({
      {"register = 0", {0xffff}, "65535000000000"},
      {"register = 0, type = 'i16'", {0xfffe}, "-2000000000"},
      {"register = 0, type = 'u16'", {0x8000}, "32768000000000"},
      {"register = 0, type = 'i32'", {0xffff, 0xfffe}, "-2000000000"},
      {"register = 0, type = 'u32'", {0xffff, 0xffff}, "4294967295000000000"},
      {"register = 0, type = 'i64'", {0xffff, 0xffff, 0xffff, 0xfffe}, "-2000000000"},
      {"register = 0, type = 'u64'", {0, 0, 1, 2}, "65538000000000"},
      {"register = 0, type = 'bcd16'", {0x1234}, "1234000000000"},
      {"register = 0, type = 'bcd32'", {0x1234, 0x5678}, "12345678000000000"},
  });
}

TEST(ProfileNumber, HasEveryTypeOfReal) {
  expect({
      {"register = 0, type = 'f32'", {0xc2f6, 0x8000}, "-123250000000"},
      {"register = 0, type = 'f64'", {0xc05e, 0xd000, 0, 0}, "-123250000000"},
      {"register = 0, type = 'f32'", {0x8000, 0}, "0"},
      {"register = 0, type = 'f32'", {0, 1}, "0"},
  });
}

TEST(ProfileNumber, HasEveryOrder) {
  expect({
      {"register = 0, order = 'AB'", {0x0102}, "258000000000"},
      {"register = 0, order = 'BA'", {0x0201}, "258000000000"},
      {"register = 0, order = 'BADC'", {0x0201}, "258000000000"},
      {"register = 0, type = 'u32', order = 'ABCD'", {0x0001, 0x0203}, "66051000000000"},
      {"register = 0, type = 'u32', order = 'BADC'", {0x0100, 0x0302}, "66051000000000"},
      {"register = 0, type = 'u32', order = 'CDAB'", {0x0203, 0x0001}, "66051000000000"},
      {"register = 0, type = 'u32', order = 'DCBA'", {0x0302, 0x0100}, "66051000000000"},
      {"register = 0, type = 'bcd32', order = 'CDAB'", {0x5678, 0x1234}, "12345678000000000"},
      {"register = 0, type = 'f32', order = 'DCBA'", {0x0080, 0xf6c2}, "-123250000000"},
  });
}

TEST(ProfileNumber, HasEveryOrderOf64Bits) {
  // The letters say which byte stands where; A is the highest.
  constexpr std::uint64_t value = 0x0011223344556677;
  for (const std::string order : {"ABCDEFGH", "BADCFEHG", "CDABGHEF", "DCBAHGFE", "EFGHABCD",
                                  "FEHGBADC", "GHEFCDAB", "HGFEDCBA"}) {
    std::vector<std::uint16_t> registers(4);
    for (std::size_t i = 0; i < 8; ++i) {
      const auto byte = static_cast<std::uint16_t>(value >> 8 * ('H' - order[i]) & 0xff);
      registers[i / 2] = static_cast<std::uint16_t>(registers[i / 2] | byte << (i % 2 ? 0 : 8));
    }
    EXPECT_EQ(
        decoded("register = 0, type = 'u64', scale = '1e-9', order = '" + order + "'", registers)
            .nano,
        static_cast<std::int64_t>(value))
        << order;
  }
  expect(
      {{"register = 0, type = 'u64', order = 'CDAB'", {4, 3, 3, 0}, "out of range"},
       {"register = 0, type = 'u64', order = 'CDAB'", {4, 3, 0, 0}, "196612000000000"},
       {"register = 0, type = 'u64', order = 'DCBA'", {0x0400, 0x0300, 0, 0}, "196612000000000"}});
}

TEST(ProfileNumber, ScaleAndOffsetAreExact) {
  expect({
      {"register = 0, type = 'i32', scale = '1/10000000'", {0xe2b3, 0x4b80}, "-49156620800"},
      {"register = 0, scale = '1/60000'", {1}, "16667"},
      {"register = 0, scale = '1/60000'", {60000}, "1000000000"},
      {"register = 0, scale = '0.1', offset = -40", {1}, "-39900000000"},
      {"register = 0, scale = -2, offset = '1/2'", {3}, "-5500000000"},
      {"register = 0, type = 'u64', scale = '1/1000'",
       {0, 0x018b, 0xcfe5, 0x6800},
       "1700000000000000000"},
      {"register = 0, type = 'f32', scale = '1/4', offset = 1", {0xc2f6, 0x8000}, "-29812500000"},
  });
}

TEST(ProfileNumber, MaskLeavesBitsWhereTheyStand) {
  expect({
      {"register = 0, mask = 0x00FF", {0x1234}, "52000000000"},
      {"register = 0, mask = 0xFF00, scale = '1/256'", {0x1234}, "18000000000"},
      {"register = 0, type = 'i16', mask = 0xFF00, scale = '1/256'", {0xfe34}, "-2000000000"},
      {"register = 0, type = 'bcd16', mask = 0x0FFF", {0xf123}, "123000000000"},
      {"register = 0, type = 'u32', mask = 0x7FFFFFFF", {0x8000, 5}, "5000000000"},
  });
}

TEST(ProfileNumber, NoneIsByItsBits) {
  expect({
      {"register = 0, type = 'u32', none = 999999999", {0x3b9a, 0xc9ff}, "none"},
      {"register = 0, type = 'i32', none = 0x7FFFFFFF", {0x7fff, 0xffff}, "none"},
      {"register = 0, type = 'i32', none = [0x7FFFFFFF, 999999999, -1]", {0xffff, 0xffff}, "none"},
      {"register = 0, type = 'i32', none = [0x7FFFFFFF, 999999999, -1]",
       {0xffff, 0xfffe},
       "-2000000000"},
      {"register = 0, type = 'i16', none = 0x8000", {0x8000}, "none"},
      {"register = 0, type = 'i16', none = -32768", {0x8000}, "none"},
      {"register = 0, type = 'i32', order = 'CDAB', none = 1", {1, 0}, "none"},
      {"register = 0, type = 'u64', none = '0xFFFFFFFFFFFFFFFF'",
       {0xffff, 0xffff, 0xffff, 0xffff},
       "none"},
      {"register = 0, type = 'u64', none = -1", {0xffff, 0xffff, 0xffff, 0xffff}, "none"},
      {"register = 0, type = 'f32', none = -9999", {0xc61c, 0x3c00}, "none"},
      {"register = 0, type = 'f32', none = '0xC61C3C00'", {0xc61c, 0x3c00}, "none"},
      {"register = 0, type = 'f64', none = '-0.5'", {0xbfe0, 0, 0, 0}, "none"},
      {"register = 0, type = 'bcd16', none = 0xFFFF", {0xffff}, "none"},
      {"register = 0, mask = 0x0FFF, none = 0x0FFF", {0x3fff}, "none"},
      {"register = 0, scale = '0.1', none = 7", {7}, "none"},
  });
}

TEST(ProfileNumber, NoNumberIsNone) {
  expect({
      {"register = 0, type = 'f32'", {0x7fc0, 0}, "none"},
      {"register = 0, type = 'f32'", {0xffff, 0xffff}, "none"},
      {"register = 0, type = 'f32'", {0x7f80, 0}, "none"},
      {"register = 0, type = 'f32'", {0xff80, 0}, "none"},
      {"register = 0, type = 'f64'", {0x7ff0, 0, 0, 0}, "none"},
      {"register = 0, type = 'f64'", {0x7ff8, 0, 0, 1}, "none"},
      {"register = 0, type = 'bcd16'", {0x12a4}, "malformed"},
      {"register = 0, type = 'bcd32'", {0x1234, 0x567f}, "malformed"},
  });
}

TEST(ProfileNumber, WhatDoesNotFitIsOutOfRange) {
  const std::vector<std::uint16_t> least{0x8000, 0, 0, 0};
  const std::vector<std::uint16_t> most{0x7fff, 0xffff, 0xffff, 0xffff};
  expect({
      {"register = 0, type = 'i64'", least, "out of range"},
      {"register = 0, type = 'i64'", most, "out of range"},
      {"register = 0, type = 'i64', scale = '1e-9'", least, "out of range"},
      {"register = 0, type = 'i64', scale = '1e-9'", most, "9223372036854775807"},
      {"register = 0, type = 'i64', scale = '-1e-9'", most, "-9223372036854775807"},
      {"register = 0, type = 'i64', scale = '1e-9', offset = '1e-9'", most, "out of range"},
      {"register = 0, type = 'i64', scale = '1e-18'", least, "-9223372037"},
      {"register = 0, type = 'u64', scale = '1e-18'", least, "out of range"},
      {"register = 0, scale = '1e18'", {1}, "out of range"},
      {"register = 0, scale = '1e18'", {0}, "0"},
      {"register = 0, type = 'f32'", {0x7f7f, 0xffff}, "out of range"},
      {"register = 0, type = 'f64'", {0xffef, 0xffff, 0xffff, 0xffff}, "out of range"},
      {"register = 0, type = 'f64', scale = '1e18'", {0x7fe0, 0, 0, 0}, "out of range"},
  });
}

std::vector<std::uint16_t> letters(std::string text, std::size_t registers) {
  text.resize(2 * registers, '\0');
  std::vector<std::uint16_t> words;
  for (std::size_t i = 0; i < text.size(); i += 2) {
    words.push_back(static_cast<std::uint16_t>(static_cast<unsigned char>(text[i]) << 8 |
                                               static_cast<unsigned char>(text[i + 1])));
  }
  return words;
}

TEST(ProfileNumber, StandsInLetters) {
  constexpr const char* field = "register = 0, type = 'ascii', count = 6";
  expect({
      {field, letters("4807.038", 6), "4807038000000"},
      {field, letters("  -12.5 ", 6), "-12500000000"},
      {field, letters("+.5", 6), "500000000"},
      {field, letters("12.5W", 6), "-12500000000"},
      {field, letters("N48.1", 6), "48100000000"},
      {field, letters("0", 6), "0"},
      {field, letters("", 6), "none"},
      {field, letters("      ", 6), "none"},
      {field, letters("--", 6), "malformed"},
      {field, letters("1.2.3", 6), "malformed"},
      {field, letters("12 5", 6), "malformed"},
      {field, letters("1e3", 6), "malformed"},
      {field, letters(".", 6), "malformed"},
      {field, letters("W", 6), "malformed"},
      {field, letters(std::string("1\0002", 3), 6), "malformed"},
      {"register = 0, type = 'ascii', count = 2, order = 'BA'", {0x3231, 0x3433}, "1234000000000"},
      {"register = 0, type = 'ascii', count = 2, format = 'ddmm.mmmm'", letters("4830", 2),
       "48500000000"},
      {"register = 0, type = 'ascii', count = 2, scale = '0.1'", letters("4830", 2),
       "483000000000"},
      {"register = 0, type = 'ascii', count = 16", letters(std::string(32, '9'), 16), "malformed"},
      {"register = 0, type = 'ascii', count = 16", letters("1." + std::string(30, '9'), 16),
       "2000000000"},
  });
}

// "-33.8S" was 33.8 degrees in the north: the sign turned what the letter had turned.
// 63.4305 as a real of 32 bits is 63.430500030517578 in the digits of a double.
TEST(ProfileNumber, ARealOf32BitsHasItsOwnDigits) {
  expect({
      {"register = 0, type = 'f32'", {0x427d, 0xb8d5}, "63430500000"},
      {"register = 0, type = 'f32'", {0xc0b3, 0x3333}, "-5600000000"},
      {"register = 0, type = 'f32', scale = '0.1', offset = 1", {0x3dcc, 0xcccd}, "1010000000"},
      {"register = 0, type = 'f32', scale = '1/3'", {0x3dcc, 0xcccd}, "33333334"},
      {"register = 0, type = 'f32'", {0x3083, 0x1270}, "1"},
      {"register = 0, type = 'f32'", {0x4b7f, 0xffff}, "16777215000000000"},
      {"register = 0, type = 'f32'", {0x4ceb, 0x79a3}, "123456792000000000"},
  });
}

TEST(ProfileNumber, ASignBesideALetterIsNoNumber) {
  constexpr const char* field = "register = 0, type = 'ascii', count = 6";
  expect({
      {field, letters("-33.8612S", 6), "malformed"},
      {field, letters("-151.2098E", 6), "malformed"},
      {field, letters("+33.8612N", 6), "malformed"},
      {field, letters("S-33.8612", 6), "malformed"},
      {field, letters("N33.8612S", 6), "malformed"},
      {field, letters("33.8612S", 6), "-33861200000"},
  });
}

}  // namespace
}  // namespace etcm::firmware
