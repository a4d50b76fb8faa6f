// What the devices of a site measure.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/config/settings.h"
#include "firmware/polling/indices.h"

namespace etcm::firmware {

// Readings of the same name and unit are of one quantity, whichever profiles they stand in.
struct Quantity {
  std::string name;
  std::string unit;  // as a person writes it, or empty
  friend bool operator==(const Quantity&, const Quantity&) = default;
};

// Adds those of the profiles that devices have and that are not known yet, in the order of the
// [[bus.device]] and, of each, of the readings of its profile. Known ones keep their numbers.
void add_quantities(const Settings& settings, std::vector<Quantity>& known);

// Of settings that were just read. What is configured behind all others leaves their numbers alone.
std::vector<Quantity> quantities_of(const Settings& settings);

// REQUIRES: the reading is of one of them.
QuantityIndex index_of(const Profile::Reading& reading, const std::vector<Quantity>& quantities);

// The readings of all devices together.
std::uint32_t count_readings(const Settings& settings);

// How many units measure anything, and each of the quantities, which are those of the settings.
struct SensorCounts {
  std::uint32_t units = 0;
  std::vector<std::uint32_t> by_quantity;
};
SensorCounts count_sensors(const Settings& settings, const std::vector<Quantity>& quantities);

// One reading of a sweep.
struct Measurement {
  QuantityIndex quantity;
  std::optional<std::int64_t> nano;  // in 10^-9 of its unit; none: it has no valid value
};

}  // namespace etcm::firmware
