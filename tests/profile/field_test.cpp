// Fields of several numbers, and tests of numbers.
#include "device.h"

namespace etcm::firmware {
namespace {

using State = FieldValue::State;
using Words = std::vector<std::uint16_t>;

TEST(ProfileField, DegreesAndMinutesInOneNumber) {
  const std::string ddmm = "register = 0, type = 'i32', scale = '1/1000', format = 'ddmm.mmmm'";
  EXPECT_EQ(decoded(ddmm, {0x0049, 0x597e}).nano, 48'117'300'000);
  EXPECT_EQ(decoded(ddmm, {0xffb6, 0xa682}).nano, -48'117'300'000);
  EXPECT_EQ(decoded("register = 0, format = 'ddmm.mmmm'", {4859}).nano, 48'983'333'333);
  EXPECT_EQ(decoded("register = 0, format = 'ddmm.mmmm'", {4860}).state, State::malformed);
  EXPECT_EQ(decoded("register = 0, format = 'degrees'", {4860}).nano, 4'860'000'000'000);
  const std::string ddmmss = "register = 0, type = 'i32', scale = '1/100', format = 'ddmmss.ss'";
  EXPECT_EQ(decoded(ddmmss, {0x02dd, 0x8a0c}).nano, 48'125'633'333);
  EXPECT_EQ(decoded(ddmmss, {0xfd22, 0x75f4}).nano, -48'125'633'333);
  EXPECT_EQ(decoded("register = 0, format = 'ddmmss.ss'", {6000}).state, State::malformed);
  EXPECT_EQ(decoded("register = 0, format = 'ddmmss.ss'", {60}).state, State::malformed);
}

TEST(ProfileField, DegreesAndMinutesInLetters) {
  const std::string ddmm = "register = 0, type = 'ascii', count = 5, format = 'ddmm.mmmm'";
  const auto state = [&](const Words& words) { return decoded(ddmm, words).state; };
  EXPECT_EQ(decoded(ddmm, {0x3438, 0x3539, 0x2e39, 0x3939, 0x4e20}).nano, 48'999'983'333);
  EXPECT_EQ(state({0x3438, 0x3630, 0x2e30, 0x3030, 0x4e20}), State::malformed) << "4860.000N";
  EXPECT_EQ(state({0x3438, 0x3939, 0x2e30, 0x3030, 0x5320}), State::malformed) << "4899.000S";
}

TEST(ProfileField, Radians) {
  EXPECT_EQ(decoded("register = 0, type = 'f32', format = 'radians'", {0x3fc9, 0x0fdb}).nano,
            90'000'002'504);
  EXPECT_EQ(
      decoded("register = 0, type = 'f64', format = 'radians'", {0x4009, 0x21fb, 0x5444, 0x2d18})
          .nano,
      180'000'000'000);
  EXPECT_EQ(
      decoded("register = 0, type = 'i32', scale = '1e-8', format = 'radians'", {0xf6a4, 0xe44c})
          .nano,
      -89'934'785'554);
  EXPECT_EQ(decoded("register = 0, offset = -1, format = 'radians'", {0}).nano, -57'295'779'513);
}

TEST(ProfileField, ASumOfParts) {
  const std::string parts =
      "parts = [{ register = 0, type = 'i16' }, { register = 1, scale = '1/600000' }]";
  EXPECT_EQ(decoded(parts, {48, 60000}).nano, 48'100'000'000);
  EXPECT_EQ(decoded(parts, {word(-48), 60000}).nano, -47'900'000'000);
  const std::string sizes = parts + ", sign_of_first = true";
  EXPECT_EQ(decoded(sizes, {word(-48), 60000}).nano, -48'100'000'000);
  EXPECT_EQ(decoded(sizes, {48, 60000}).nano, 48'100'000'000);
  EXPECT_EQ(decoded(sizes, {0, 60000}).nano, 100'000'000);
  const std::string three =
      "parts = [{ register = 0 }, { register = 1, scale = '1/60' }, { register = 2, none = 99 }]";
  EXPECT_EQ(decoded(three, {1, 30, 0}).nano, 1'500'000'000);
  EXPECT_EQ(decoded(three, {1, 30, 99}).state, State::none);
  const std::string large =
      "parts = [{ register = 0, type = 'u32' }, { register = 0, type = 'u32' }, "
      "{ register = 0, type = 'u32' }]";
  EXPECT_EQ(decoded(large, {0xffff, 0xffff}).state, State::out_of_range);
}

TEST(ProfileField, AScaleFactorInARegister) {
  const std::string sunspec =
      "register = 0, type = 'i16', none = 0x8000, exponent = { register = 1, type = 'i16' }";
  EXPECT_EQ(decoded(sunspec, {2305, word(-1)}).nano, 230'500'000'000);
  EXPECT_EQ(decoded(sunspec, {word(-5), 2}).nano, -500'000'000'000);
  EXPECT_EQ(decoded(sunspec, {5, 0}).nano, 5'000'000'000);
  EXPECT_EQ(decoded(sunspec, {5, 0x8000}).state, State::out_of_range);
  EXPECT_EQ(decoded(sunspec, {5, 19}).state, State::out_of_range);
  EXPECT_EQ(decoded(sunspec, {5, 18}).state, State::out_of_range);
  EXPECT_EQ(decoded(sunspec, {5, word(-18)}).nano, 0);
  EXPECT_EQ(decoded(sunspec, {0x8000, 1}).state, State::none);
  EXPECT_EQ(
      decoded("register = 0, type = 'ascii', count = 2, exponent = { register = 2, type = 'i16' }",
              {0x312e, 0x3520, word(-18)})
          .state,
      State::out_of_range);
  EXPECT_EQ(
      decoded("register = 0, type = 'f32', exponent = { register = 2, none = 9 }", {0x3fc0, 0, 3})
          .nano,
      1'500'000'000'000);
  EXPECT_EQ(decoded("register = 0, exponent = { register = 2, none = 9 }", {1, 0, 9}).state,
            State::none);
  EXPECT_EQ(decoded("register = 0, exponent = { register = 2, scale = '1/2' }", {1, 0, 1}).state,
            State::out_of_range);
}

TEST(ProfileField, ASignOfItsOwn) {
  const std::string hemisphere = "register = 0, negative_if = { register = 1, equals = 'W' }";
  EXPECT_EQ(decoded(hemisphere, {5, 'W'}).nano, -5'000'000'000);
  EXPECT_EQ(decoded(hemisphere, {5, 'E'}).nano, 5'000'000'000);
  const std::string size_and_sign =
      "register = 0, type = 'u32', mask = 0x7FFFFFFF, "
      "negative_if = { register = 0, mask = 0x8000, not_equals = 0 }";
  EXPECT_EQ(decoded(size_and_sign, {0x8000, 7}).nano, -7'000'000'000);
  EXPECT_EQ(decoded(size_and_sign, {0, 7}).nano, 7'000'000'000);
  EXPECT_EQ(
      decoded("register = 0, range = [-6, -4], negative_if = { register = 1, equals = 1 }", {5, 1})
          .nano,
      -5'000'000'000);
}

TEST(ProfileField, AGainInARegister) {
  const std::string gain =
      "register = 0, type = 'i16', factor = { register = 1, scale = '0.001', none = 0xFFFF }";
  EXPECT_EQ(decoded(gain, {word(-200), 1500}).nano, -300'000'000'000);
  EXPECT_EQ(decoded(gain, {200, 0}).nano, 0);
  EXPECT_EQ(decoded(gain, {200, 0xffff}).state, State::none);
  EXPECT_EQ(
      decoded("parts = [{ register = 0 }, { register = 1 }], factor = { register = 2 }", {2, 3, 7})
          .nano,
      35'000'000'000);
  EXPECT_EQ(decoded("register = 0, type = 'f32', factor = { register = 2, type = 'f32' }",
                    {0x3f00, 0, 0x4080, 0})
                .nano,
            2'000'000'000);
  const std::string large = "register = 0, type = 'u32', factor = { register = 0, type = 'u32' }";
  EXPECT_EQ(decoded(large, {0xffff, 0xffff}).state, State::out_of_range);
}

// As the guide has it.
TEST(ProfileField, EightBitsWithASign) {
  const std::string low =
      "parts = [{ register = 0, mask = 0x7F }, { register = 0, mask = 0x80, scale = -1 }]";
  EXPECT_EQ(decoded(low, {0x55ff}).nano, -1'000'000'000);
  EXPECT_EQ(decoded(low, {0x5580}).nano, -128'000'000'000);
  EXPECT_EQ(decoded(low, {0x557f}).nano, 127'000'000'000);
  const std::string high = "register = 0, type = 'i16', mask = 0xFF00, scale = '1/256'";
  EXPECT_EQ(decoded(high, {0xff55}).nano, -1'000'000'000);
  EXPECT_EQ(decoded(high, {0x7f55}).nano, 127'000'000'000);
}

TEST(ProfileField, ARangeOfWhatComesOut) {
  const std::string range = "register = 0, type = 'i16', scale = '0.1', range = ['-1.5', 2]";
  EXPECT_EQ(decoded(range, {word(-15)}).nano, -1'500'000'000);
  EXPECT_EQ(decoded(range, {20}).nano, 2'000'000'000);
  EXPECT_EQ(decoded(range, {word(-16)}).state, State::out_of_range);
  EXPECT_EQ(decoded(range, {21}).state, State::out_of_range);
  EXPECT_EQ(decoded(range, {21}).nano, 2'100'000'000);
}

// A reading is there where its test holds.
bool holds(const std::string& test, const Words& registers) {
  Device device(
      sound_profile("[[profile]]\nname = 'p'\n[[profile.reading]]\nname = 'r'\n"
                    "value = { register = 100 }\nvalid = " +
                    test + "\n"));
  device.set(0, registers);
  return device.reading().is_value();
}

TEST(ProfileTest, ComparesWithOneOrSeveral) {
  EXPECT_TRUE(holds("{ register = 0, equals = 1 }", {1}));
  EXPECT_FALSE(holds("{ register = 0, equals = 1 }", {2}));
  EXPECT_TRUE(holds("{ register = 0, equals = [2, 3] }", {3}));
  EXPECT_FALSE(holds("{ register = 0, equals = [2, 3] }", {4}));
  EXPECT_TRUE(holds("{ register = 0, not_equals = 0 }", {4}));
  EXPECT_FALSE(holds("{ register = 0, not_equals = 0 }", {0}));
  EXPECT_FALSE(holds("{ register = 0, not_equals = [0, 0xFFFF] }", {0xffff}));
  EXPECT_TRUE(holds("{ register = 0, at_least = 2 }", {2}));
  EXPECT_FALSE(holds("{ register = 0, at_least = 2 }", {1}));
  EXPECT_TRUE(holds("{ register = 0, at_most = 2 }", {2}));
  EXPECT_FALSE(holds("{ register = 0, at_most = 2 }", {3}));
  EXPECT_TRUE(holds("{ register = 0, at_least = 2, at_most = 3 }", {3}));
  EXPECT_FALSE(holds("{ register = 0, at_least = 2, at_most = 3 }", {4}));
}

TEST(ProfileTest, LooksAtBitsAndLetters) {
  EXPECT_TRUE(holds("{ register = 0, equals = 'A' }", {0x0041}));
  EXPECT_FALSE(holds("{ register = 0, equals = 'A' }", {0x4100}));
  EXPECT_TRUE(holds("{ register = 0, mask = 0x00FF, equals = 'A' }", {0x5641}));
  EXPECT_TRUE(holds("{ register = 0, mask = 0xFF00, equals = 'A' }", {0x4156}));
  EXPECT_FALSE(holds("{ register = 0, mask = 0xFF00, equals = 'A' }", {0x5641}));
  EXPECT_TRUE(holds("{ register = 0, mask = 0xFF00, equals = ['A', 'D'] }", {0x4400}));
  EXPECT_TRUE(holds("{ register = 0, mask = 0x0300, equals = 0x0200 }", {0xfeff}));
  EXPECT_TRUE(holds("{ register = 0, mask = 0x0008, not_equals = 0 }", {0x000a}));
  EXPECT_FALSE(holds("{ register = 0, mask = 0x0008, not_equals = 0 }", {0x0002}));
}

TEST(ProfileTest, ADigitInLettersIsItsNumber) {
  const std::string status = "{ register = 0, type = 'ascii', count = 1, equals = '1' }";
  EXPECT_TRUE(holds(status, {0x3120}));
  EXPECT_FALSE(holds(status, {0x3220}));
  EXPECT_FALSE(holds(status, {0x0001}));
}

TEST(ProfileTest, KnowsEveryType) {
  EXPECT_TRUE(holds("{ register = 0, type = 'i16', at_least = -1 }", {0xffff}));
  EXPECT_FALSE(holds("{ register = 0, type = 'i16', at_least = 0 }", {0xffff}));
  EXPECT_TRUE(holds("{ register = 0, type = 'i16', equals = -1 }", {0xffff}));
  EXPECT_TRUE(holds("{ register = 0, type = 'u32', equals = 0xFFFFFFFF }", {0xffff, 0xffff}));
  EXPECT_TRUE(holds("{ register = 0, type = 'f32', at_most = '1.5' }", {0x3fc0, 0}));
  EXPECT_FALSE(holds("{ register = 0, type = 'f32', at_most = '1.4' }", {0x3fc0, 0}));
  EXPECT_TRUE(holds("{ register = 0, scale = '0.1', at_most = '1.5' }", {15}));
  // What is no number is like nothing, and unlike nothing.
  EXPECT_FALSE(holds("{ register = 0, type = 'f32', not_equals = 0 }", {0x7fc0, 0}));
  EXPECT_FALSE(holds("{ register = 0, type = 'f32', at_most = 0 }", {0xff80, 0}));
}

TEST(ProfileTest, AllOfSeveralHold) {
  const std::string both = "[{ register = 0, equals = 1 }, { register = 300, equals = 0 }]";
  EXPECT_TRUE(holds(both, {1}));
  EXPECT_FALSE(holds(both, {0}));
}

}  // namespace
}  // namespace etcm::firmware
