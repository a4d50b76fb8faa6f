// What the registers of a kind of device mean: which are read, in which blocks, and what one
// complete sweep of them says.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "etcm/port/clock.h"
#include "firmware/profile/field.h"

namespace etcm::firmware {

// So that they fit lines, labels and registers, in bytes.
inline constexpr std::size_t reading_name_max = 48;
inline constexpr std::size_t reading_unit_max = 24;

struct Profile {
  // How the position is known. One that was surveyed stands in the settings or the site file.
  enum class Positioning : std::uint8_t { surveyed, plane, degrees };
  struct Reading {
    std::string name;
    std::string unit;  // as a person writes it, or empty
    Field value;
    std::vector<Condition> valid;  // of this reading: all hold
    friend bool operator==(const Reading&, const Reading&) = default;
  };

  std::string name;
  std::uint8_t function = 3;
  std::uint32_t counts_from = 0;  // what the profile's author calls register 0
  port::Duration pause{};         // that the device needs after each answer
  std::optional<Field> serial;    // none: the serial is made of bus and unit
  std::vector<Condition> valid;   // of the position: all hold
  Positioning positioning = Positioning::surveyed;
  Field east;   // x or longitude
  Field north;  // y or latitude
  // How far it moves in a second at the most, in 10^-9 of metres or of what the plane counts in; 0:
  // nobody has said.
  std::int64_t speed_max_nano = 0;
  std::vector<Reading> readings;
  std::uint16_t block_max = 125;  // registers that the device gives at once
  std::uint16_t gap_max = 0;      // registers of no use that may be read between others
  friend bool operator==(const Profile&, const Profile&) = default;
};

// Every number's registers, with repetitions.
std::vector<RegisterSpan> spans_of(const Profile& profile);

// The fewest blocks, in the order of their addresses, that have each number whole.
// REQUIRES: no number is longer than block_max.
std::vector<RegisterSpan> blocks_of(const Profile& profile);

// ---- What a sweep of these blocks says. None of these allocates.

struct DevicePosition {
  enum class State : std::uint8_t {
    value,
    invalid,           // the device says so
    unknown,           // the profile has no position
    none,              // a coordinate has no value
    malformed,         // one is not written as its type and format say
    out_of_range,      // one is outside its `range`, or beyond what can be counted
    zero,              // 0, 0 in degrees, where nobody is
    beyond_longitude,  // 180 degrees
    beyond_latitude,   // 90 degrees
    // Where its `negative_if` looks for a letter there is something else.
    no_letter_of_longitude,
    no_letter_of_latitude,
    // The letter of a hemisphere stands where it does not belong.
    north_in_longitude,
    south_in_longitude,
    east_in_latitude,
    west_in_latitude,
  };
  State state = State::unknown;
  // In 10^-9; of degrees within 180 and 90.
  std::int64_t east_nano = 0;
  std::int64_t north_nano = 0;

  bool is_value() const { return state == State::value; }
  // What the device says cannot be meant: the profile, or the device, has its coordinates
  // exchanged.
  bool is_exchanged() const { return state >= State::north_in_longitude; }
};

// Why there is none, as what a node says or is, and what to do about that.
struct NoPosition {
  const char* what;
  const char* cure;
};
NoPosition explain(DevicePosition::State state);

DevicePosition position_of(const Profile& profile, const Sweep& sweep);

// None where the reading's own test does not hold.
FieldValue reading_of(const Profile::Reading& reading, const Sweep& sweep);

// A whole number from 0 to 4294967294; nothing for others, and where the profile has no such field.
std::optional<std::uint32_t> serial_of(const Profile& profile, const Sweep& sweep);

bool hold_all(std::span<const Condition> conditions, const Sweep& sweep);

}  // namespace etcm::firmware
