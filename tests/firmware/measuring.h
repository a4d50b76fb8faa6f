// A gateway on a line with devices that measure.
#pragma once

#include <bit>
#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "device_test.h"
#include "firmware/publish/reading_snapshot.h"

namespace etcm::firmware {

// A tank and a well both measure a level in m, and the well a temperature too. A rover measures
// where it is not surveyed.
inline const std::string measuring_settings = R"(
[[profile]]
name = "tank"
[[profile.reading]]
name = "level"
unit = "m"
value = { register = 3, type = "i16", scale = "0.001", none = 32767, range = ["-10", "20"] }
[[profile]]
name = "well"
serial = { register = 20, type = "u32" }
[[profile.reading]]
name = "temperature"
unit = "°C"
value = { register = 10, type = "f32" }
[[profile.reading]]
name = "level"
unit = "m"
value = { register = 12, type = "i32", scale = "0.000000001" }
valid = { register = 14, equals = 1 }
[[profile]]
name = "rover"
valid = { register = 30, equals = 1 }
x = { register = 31, type = "i16" }
y = { register = 32, type = "i16" }
[[profile.reading]]
name = "level"
unit = "cm"
value = { register = 33, type = "i16" }
[[profile]]
name = "unused"
[[profile.reading]]
name = "nothing"
value = { register = 3 }
)" + device_line + R"([[bus.device]]
units = "2-3"
profile = "tank"
[[bus.device]]
units = "5-6"
profile = "well"
[[bus.device]]
units = "8"
profile = "rover"
[[node]]
unit = 2
x = 0
y = 0
[[node]]
unit = 3
x = 100
y = 0
[[node]]
unit = 5
x = 0
y = 100
)";

class Measuring : public DeviceTest {
 protected:
  void start(const std::string& text = measuring_settings) { DeviceTest::start(text); }
  void put_tank(std::uint8_t unit, std::int16_t level_mm) {
    bus_.put(unit, 3, {static_cast<std::uint16_t>(level_mm)});
  }
  void put_well(std::uint8_t unit, std::uint32_t serial, float temperature, std::int32_t level_nano,
                bool is_level_valid = true) {
    const auto high = [](std::uint32_t value) { return static_cast<std::uint16_t>(value >> 16); };
    const auto low = [](std::uint32_t value) { return static_cast<std::uint16_t>(value); };
    const auto bits = std::bit_cast<std::uint32_t>(temperature);
    const auto level = static_cast<std::uint32_t>(level_nano);
    bus_.put(unit, 20, {high(serial), low(serial)});
    bus_.put(unit, 10, {high(bits), low(bits), high(level), low(level), is_level_valid});
  }
  void put_rover(std::uint8_t unit, std::int16_t x, std::int16_t y, std::int16_t level,
                 bool has_fix = true) {
    bus_.put(unit, 30,
             {has_fix, static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
              static_cast<std::uint16_t>(level)});
  }
  const ReadingSnapshot& published() const { return rig_.gateway->readings(); }
  const PublishedReading* reading(std::uint32_t serial, const std::string& name) const {
    for (const PublishedReading& found : readings_of(published(), Serial{serial})) {
      if (published().quantities[found.quantity.value].name == name) return &found;
    }
    return nullptr;
  }
  std::optional<std::int64_t> nano(std::uint32_t serial, const std::string& name = "level") const {
    const PublishedReading* const found = reading(serial, name);
    return found == nullptr ? std::nullopt : found->nano;
  }
  bool is_stale(std::uint32_t serial, const std::string& name = "level") const {
    const PublishedReading* const found = reading(serial, name);
    return found != nullptr && found->is_stale;
  }
};

}  // namespace etcm::firmware
