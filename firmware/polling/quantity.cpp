#include "firmware/polling/quantity.h"

#include <algorithm>

namespace etcm::firmware {

namespace {

bool is_of(const Profile::Reading& reading, const Quantity& quantity) {
  return reading.name == quantity.name && reading.unit == quantity.unit;
}

// Calls visit() for the profile of each unit that has one.
template <class Visit>
void for_each_profile(const Settings& settings, Visit visit) {
  for (const BusSettings& bus : settings.buses) {
    for (const ModbusAddress address : UnitRange{.first = 1, .last = unit_max}) {
      const DeviceSettings* const device = device_at(bus, address);
      const Profile* const profile =
          device == nullptr ? nullptr : find_profile(settings, device->profile);
      if (profile != nullptr) visit(*profile);
    }
  }
}

}  // namespace

void add_quantities(const Settings& settings, std::vector<Quantity>& known) {
  for (const BusSettings& bus : settings.buses) {
    for (const DeviceSettings& device : bus.devices) {
      const Profile* const profile = find_profile(settings, device.profile);
      if (profile == nullptr) continue;
      for (const Profile::Reading& reading : profile->readings) {
        const bool is_known =
            std::any_of(known.begin(), known.end(),
                        [&](const Quantity& quantity) { return is_of(reading, quantity); });
        if (!is_known) known.push_back({.name = reading.name, .unit = reading.unit});
      }
    }
  }
}

std::vector<Quantity> quantities_of(const Settings& settings) {
  std::vector<Quantity> quantities;
  add_quantities(settings, quantities);
  return quantities;
}

QuantityIndex index_of(const Profile::Reading& reading, const std::vector<Quantity>& quantities) {
  const auto found = std::find_if(quantities.begin(), quantities.end(),
                                  [&](const Quantity& known) { return is_of(reading, known); });
  return QuantityIndex{static_cast<std::uint32_t>(found - quantities.begin())};
}

std::uint32_t count_readings(const Settings& settings) {
  std::size_t count = 0;
  for_each_profile(settings, [&](const Profile& profile) { count += profile.readings.size(); });
  return static_cast<std::uint32_t>(count);
}

SensorCounts count_sensors(const Settings& settings, const std::vector<Quantity>& quantities) {
  SensorCounts counts{.units = 0, .by_quantity = std::vector<std::uint32_t>(quantities.size())};
  for_each_profile(settings, [&](const Profile& profile) {
    if (!profile.readings.empty()) ++counts.units;
    for (const Profile::Reading& reading : profile.readings) {
      ++counts.by_quantity[index_of(reading, quantities).value];
    }
  });
  return counts;
}

}  // namespace etcm::firmware
