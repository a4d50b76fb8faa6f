// A profile of a device, and behind part_end the registers that such a device has.
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "firmware/profile/fingerprint.h"
#include "firmware/profile/profile_reader.h"
#include "text_parts.h"

namespace etcm::fuzz {
namespace {

using firmware::DevicePosition;
using firmware::FieldValue;

constexpr std::int64_t beyond = std::numeric_limits<std::int64_t>::min();

void check_position(const firmware::Profile& profile, const firmware::Sweep& sweep) {
  const DevicePosition position = firmware::position_of(profile, sweep);
  if (!position.is_value()) return;
  require(position.east_nano != beyond && position.north_nano != beyond, "a place beyond all");
  if (profile.positioning != firmware::Profile::Positioning::degrees) return;
  require(std::abs(position.east_nano) <= 180 * firmware::nano_per_one &&
              std::abs(position.north_nano) <= 90 * firmware::nano_per_one,
          "degrees beyond the earth");
}

void check_readings(const firmware::Profile& profile, const firmware::Sweep& sweep) {
  for (const auto& reading : profile.readings) {
    const FieldValue value = firmware::reading_of(reading, sweep);
    if (!value.is_value()) continue;
    require(value.nano != beyond, "a value beyond all");
    require(!reading.value.least || value.nano >= *reading.value.least, "below its range");
    require(!reading.value.most || value.nano <= *reading.value.most, "above its range");
    static_cast<void>(firmware::fingerprint(profile, reading));
  }
}

void sweep(const firmware::Profile& profile, std::span<const std::uint8_t> bytes) {
  const std::vector<firmware::RegisterSpan> blocks = firmware::blocks_of(profile);
  std::size_t count = 0;
  for (const firmware::RegisterSpan& block : blocks) {
    require(block.count >= 1 && block.count <= profile.block_max, "a block of a wrong size");
    require(block.end() <= 65536, "a block beyond the last register");
    count += block.count;
  }
  Input input(bytes);
  for (int round = 0; round < 4; ++round) {
    std::vector<std::uint16_t> registers(count);
    for (std::uint16_t& value : registers) value = input.word();
    const firmware::Sweep found(blocks, registers);
    check_position(profile, found);
    check_readings(profile, found);
    static_cast<void>(firmware::serial_of(profile, found));
    if (input.is_empty()) return;
  }
}

}  // namespace

void run(std::span<const std::uint8_t> bytes) {
  std::string_view text = text_of(bytes);
  const std::string path = scratch().write("profile.toml", take_part(text));
  std::vector<std::string> mistakes;
  const auto profiles = firmware::read_profiles(path, mistakes);
  for (const std::string& mistake : mistakes) {
    require(!mistake.empty() && mistake.find('\n') == mistake.npos, "a mistake is not one line");
  }
  if (!mistakes.empty()) return;
  const auto* const behind = reinterpret_cast<const std::uint8_t*>(text.data());
  for (const firmware::Profile& profile : profiles) sweep(profile, {behind, text.size()});
}

}  // namespace etcm::fuzz
