// What tells one reading of a profile from another, from one run of the gateway to the next.
#include "firmware/profile/fingerprint.h"

#include <gtest/gtest.h>

#include <set>

namespace etcm::firmware {
namespace {

Profile level_meter() {
  Profile profile;
  profile.name = "meter";
  Number number;
  number.span = {.first = 3, .count = 1};
  number.type = NumberType::i16;
  number.scale = *Fraction::parse("0.001");
  number.none = {0x7fff};
  Field value;
  value.parts = {number};
  value.least = -10 * nano_per_one;
  value.most = 20 * nano_per_one;
  profile.readings = {{.name = "level", .unit = "m", .value = value, .valid = {}}};
  return profile;
}

std::uint64_t print_of(const Profile& profile) {
  return fingerprint(profile, profile.readings.front());
}

TEST(Fingerprint, StaysTheSameFromVersionToVersion) {
  EXPECT_EQ(print_of(level_meter()), 5919069620646944205u);
}

TEST(Fingerprint, IsThatOfTheReadingAlone) {
  Profile other = level_meter();
  other.name = "another";
  other.gap_max = 9;
  other.readings.push_back(other.readings.front());
  other.readings.back().name = "temperature";
  EXPECT_EQ(print_of(other), print_of(level_meter()));
}

TEST(Fingerprint, IsAnotherForWhateverIsReadInAnotherWay) {
  std::set<std::uint64_t> prints = {print_of(level_meter())};
  const auto add = [&](auto change) {
    Profile profile = level_meter();
    change(profile, profile.readings.front(), profile.readings.front().value.parts.front());
    EXPECT_TRUE(prints.insert(print_of(profile)).second) << prints.size();
  };
  add([](Profile& profile, auto&, auto&) { profile.function = 4; });
  add([](auto&, Profile::Reading& reading, auto&) { reading.name = "levels"; });
  add([](auto&, Profile::Reading& reading, auto&) { reading.unit = ""; });
  // A letter that goes over from one to the other.
  add([](auto&, Profile::Reading& reading, auto&) { reading.name = "levelm", reading.unit = ""; });
  add([](auto&, auto&, Number& number) { number.span.first = 4; });
  add([](auto&, auto&, Number& number) { number.span.count = 2; });
  add([](auto&, auto&, Number& number) { number.type = NumberType::u16; });
  add([](auto&, auto&, Number& number) { number.order.are_bytes_swapped = true; });
  add([](auto&, auto&, Number& number) { number.order.are_words_swapped = true; });
  add([](auto&, auto&, Number& number) { number.order.are_pairs_swapped = true; });
  add([](auto&, auto&, Number& number) { number.mask = 0xff; });
  add([](auto&, auto&, Number& number) { number.scale = *Fraction::parse("0.002"); });
  add([](auto&, auto&, Number& number) { number.offset_nano = 1; });
  add([](auto&, auto&, Number& number) { number.offset_nano = -1; });
  add([](auto&, auto&, Number& number) { number.none = {}; });
  add([](auto&, auto&, Number& number) { number.none = {0x7ffe}; });
  add([](auto&, Profile::Reading& reading, auto&) { reading.value.parts.push_back({}); });
  add([](auto&, Profile::Reading& reading, auto&) { reading.value.has_sign_of_first = true; });
  add([](auto&, Profile::Reading& reading, auto&) { reading.value.exponent = Number{}; });
  add([](auto&, Profile::Reading& reading, auto&) { reading.value.factor = Number{}; });
  add([](auto&, Profile::Reading& reading, auto&) { reading.value.format = FieldFormat::ddmm; });
  add([](auto&, Profile::Reading& reading, auto&) { reading.value.negative_if = Condition{}; });
  add([](auto&, Profile::Reading& reading, auto&) { reading.value.least.reset(); });
  add([](auto&, Profile::Reading& reading, auto&) { reading.value.most.reset(); });
  add([](auto&, Profile::Reading& reading, auto&) { reading.valid = {{}}; });
  add([](auto&, Profile::Reading& reading, auto&) {
    reading.valid = {{.number = {}, .any_of = {{1, 1}}}};
  });
  add([](auto&, Profile::Reading& reading, auto&) {
    reading.valid = {{.number = {}, .any_of = {{1, 1}}, .is_negated = true}};
  });
}

}  // namespace
}  // namespace etcm::firmware
