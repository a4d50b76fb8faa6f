#include "firmware/profile/profile.h"

#include <algorithm>

namespace etcm::firmware {

namespace {

constexpr std::int64_t serial_last = 0xfffffffe;
constexpr std::int64_t longitude_max = 180 * nano_per_one;
constexpr std::int64_t latitude_max = 90 * nano_per_one;

bool is_within(std::int64_t nano, std::int64_t most) { return nano >= -most && nano <= most; }

using PositionState = DevicePosition::State;

PositionState state_on_earth(std::int64_t longitude, std::int64_t latitude) {
  if (longitude == 0 && latitude == 0) return PositionState::zero;
  if (!is_within(longitude, longitude_max)) return PositionState::beyond_longitude;
  return is_within(latitude, latitude_max) ? PositionState::value : PositionState::beyond_latitude;
}

PositionState state_of(const FieldValue& coordinate, Axis axis) {
  switch (coordinate.state) {
    case FieldValue::State::value:
      return PositionState::value;
    case FieldValue::State::none:
      return PositionState::none;
    case FieldValue::State::malformed:
      return PositionState::malformed;
    case FieldValue::State::out_of_range:
      return PositionState::out_of_range;
    case FieldValue::State::no_letter:
      return axis == Axis::latitude ? PositionState::no_letter_of_latitude
                                    : PositionState::no_letter_of_longitude;
    case FieldValue::State::other_axis:
      switch (coordinate.letter) {
        case 'N':
          return PositionState::north_in_longitude;
        case 'S':
          return PositionState::south_in_longitude;
        case 'E':
          return PositionState::east_in_latitude;
        default:
          return PositionState::west_in_latitude;
      }
  }
  return PositionState::none;
}

constexpr const char* look_at_sky = "look at the sky above its antenna, and its cable";
// What is 0 or empty may be the position of a device that knows none, or no position at all.
constexpr const char* look_at_sky_or_profile =
    "look at the sky above its antenna, and its cable; if it has a fix, correct 'register', "
    "'function' and 'counts_from' in its profile (etcm-bus probe shows what stands there)";
constexpr const char* correct_field =
    "correct 'register', 'type', 'order', 'scale' and 'format' of its coordinates in the profile "
    "(etcm-bus probe shows what each gives)";
constexpr const char* correct_letter =
    "correct 'register' and 'mask' there in the profile: mask = 0x00FF for a letter in the low "
    "byte, 0xFF00 in the high one (etcm-bus probe shows what stands there)";
constexpr const char* exchange_axes =
    "exchange the registers of 'longitude' and 'latitude' in the profile, or their letters";

}  // namespace

std::vector<RegisterSpan> spans_of(const Profile& profile) {
  std::vector<RegisterSpan> spans;
  if (profile.serial) add_spans(*profile.serial, spans);
  for (const Condition& condition : profile.valid) add_spans(condition, spans);
  if (profile.positioning != Profile::Positioning::surveyed) {
    add_spans(profile.east, spans);
    add_spans(profile.north, spans);
  }
  for (const Profile::Reading& reading : profile.readings) {
    add_spans(reading.value, spans);
    for (const Condition& condition : reading.valid) add_spans(condition, spans);
  }
  return spans;
}

std::vector<RegisterSpan> blocks_of(const Profile& profile) {
  std::vector<RegisterSpan> spans = spans_of(profile);
  std::sort(spans.begin(), spans.end(),
            [](RegisterSpan a, RegisterSpan b) { return a.first < b.first; });
  // A block that begins where it must and ends as late as it may leaves the least to those behind
  // it; what does not fit and overlaps it begins another, which has all that begins later.
  std::vector<RegisterSpan> blocks;
  for (const RegisterSpan span : spans) {
    if (!blocks.empty()) {
      RegisterSpan& block = blocks.back();
      const unsigned end = std::max(block.end(), span.end());
      const bool is_near = span.first <= block.end() + profile.gap_max;
      if (is_near && end - block.first <= profile.block_max) {
        block.count = static_cast<std::uint16_t>(end - block.first);
        continue;
      }
    }
    blocks.push_back(span);
  }
  return blocks;
}

bool hold_all(std::span<const Condition> conditions, const Sweep& sweep) {
  return std::all_of(conditions.begin(), conditions.end(),
                     [&](const Condition& condition) { return condition.holds(sweep); });
}

DevicePosition position_of(const Profile& profile, const Sweep& sweep) {
  if (profile.positioning == Profile::Positioning::surveyed) return {};
  if (!hold_all(profile.valid, sweep)) return {.state = PositionState::invalid};
  const FieldValue east = decode(profile.east, sweep);
  const FieldValue north = decode(profile.north, sweep);
  PositionState state = state_of(east, Axis::longitude);
  if (state == PositionState::value) state = state_of(north, Axis::latitude);
  if (state == PositionState::value && profile.positioning == Profile::Positioning::degrees) {
    state = state_on_earth(east.nano, north.nano);
  }
  if (state != PositionState::value) return {.state = state};
  return {.state = PositionState::value, .east_nano = east.nano, .north_nano = north.nano};
}

NoPosition explain(DevicePosition::State state) {
  switch (state) {
    case PositionState::value:
      return {"says that its position is not valid", look_at_sky};
    case PositionState::invalid:
      return {"says that its position is not valid",
              "look at the sky above its antenna, and its cable; if it has a fix, correct 'valid', "
              "'function' and 'counts_from' in its profile (etcm-bus probe shows what stands "
              "there)"};
    case PositionState::unknown:
      return {"has a profile without a position, and the settings do not say where it stands",
              "give it a [[node]] with its bus, its unit and x, y or longitude, latitude"};
    case PositionState::none:
      return {"says that a coordinate has no value", look_at_sky_or_profile};
    case PositionState::malformed:
      return {
          "has a coordinate that is not written as its type and format say (60 minutes or "
          "more, or no number)",
          correct_field};
    case PositionState::out_of_range:
      return {"has a coordinate outside its 'range', or too large to be counted",
              "correct 'range' in the profile, or its other keys (etcm-bus probe shows what each "
              "coordinate is)"};
    case PositionState::zero:
      return {
          "says that it is at 0, 0 degrees, as a device without a fix does, and one whose position "
          "is in other registers",
          look_at_sky_or_profile};
    case PositionState::beyond_longitude:
      return {"has a longitude beyond 180 degrees", correct_field};
    case PositionState::beyond_latitude:
      return {"has a latitude beyond 90 degrees", correct_field};
    case PositionState::no_letter_of_longitude:
      return {"has no E and no W where 'negative_if' of its longitude looks for the letter",
              correct_letter};
    case PositionState::no_letter_of_latitude:
      return {"has no N and no S where 'negative_if' of its latitude looks for the letter",
              correct_letter};
    case PositionState::north_in_longitude:
      return {"has the letter N in its longitude, where only E and W belong", exchange_axes};
    case PositionState::south_in_longitude:
      return {"has the letter S in its longitude, where only E and W belong", exchange_axes};
    case PositionState::east_in_latitude:
      return {"has the letter E in its latitude, where only N and S belong", exchange_axes};
    case PositionState::west_in_latitude:
      return {"has the letter W in its latitude, where only N and S belong", exchange_axes};
  }
  return {"", ""};
}

FieldValue reading_of(const Profile::Reading& reading, const Sweep& sweep) {
  return hold_all(reading.valid, sweep) ? decode(reading.value, sweep) : FieldValue{};
}

std::optional<std::uint32_t> serial_of(const Profile& profile, const Sweep& sweep) {
  if (!profile.serial) return std::nullopt;
  const FieldValue found = decode(*profile.serial, sweep);
  const std::int64_t serial = found.nano / nano_per_one;
  const bool is_serial =
      found.is_value() && found.nano % nano_per_one == 0 && serial >= 0 && serial <= serial_last;
  return is_serial ? std::optional(static_cast<std::uint32_t>(serial)) : std::nullopt;
}

}  // namespace etcm::firmware
