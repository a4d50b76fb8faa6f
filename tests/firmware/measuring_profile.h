// A device that measures, with the registers of a node of our own.
#pragma once

#include <cstdint>

#include "firmware/profile/profile.h"

namespace etcm::firmware {

inline Field field_at(std::uint16_t first, NumberType type) {
  Number number;
  number.span = {.first = first, .count = register_count_of(type)};
  number.type = type;
  Field field;
  field.parts = {number};
  return field;
}

// The registers of a node, taken for those of a device that measures.
inline Profile measuring_profile() {
  Profile profile;
  profile.name = "a profile with a name that no short string holds";
  profile.serial = field_at(2, NumberType::u32);
  profile.positioning = Profile::Positioning::plane;
  profile.east = field_at(5, NumberType::i32);
  profile.north = field_at(7, NumberType::i32);
  profile.readings = {
      {.name = "a reading with a name that no short string holds",
       .unit = "a unit with a name that no short string holds",
       .value = field_at(5, NumberType::i32),
       .valid = {}},
      {.name = "magic", .unit = {}, .value = field_at(0, NumberType::u16), .valid = {}},
      {.name = "sequence", .unit = {}, .value = field_at(11, NumberType::u16), .valid = {}}};
  profile.gap_max = 10;
  return profile;
}

}  // namespace etcm::firmware
