#include "firmware/profile/profile.h"

#include <algorithm>

namespace etcm::firmware {

namespace {

constexpr std::int64_t serial_last = 0xfffffffe;
constexpr std::int64_t longitude_max = 180 * nano_per_one;
constexpr std::int64_t latitude_max = 90 * nano_per_one;

bool is_within(std::int64_t nano, std::int64_t most) { return nano >= -most && nano <= most; }

bool is_on_earth(std::int64_t longitude, std::int64_t latitude) {
  const bool is_null = longitude == 0 && latitude == 0;
  return !is_null && is_within(longitude, longitude_max) && is_within(latitude, latitude_max);
}

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
  if (!hold_all(profile.valid, sweep)) return {.state = DevicePosition::State::invalid};
  const FieldValue east = decode(profile.east, sweep);
  const FieldValue north = decode(profile.north, sweep);
  if (!east.is_value() || !north.is_value()) return {};
  if (profile.positioning == Profile::Positioning::degrees && !is_on_earth(east.nano, north.nano)) {
    return {};
  }
  return {.state = DevicePosition::State::value, .east_nano = east.nano, .north_nano = north.nano};
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
