#include "firmware/publish/reading_snapshot.h"

#include <algorithm>

namespace etcm::firmware {

std::span<const PublishedReading> readings_of(const ReadingSnapshot& snapshot, Serial serial) {
  const auto& all = snapshot.readings;
  const auto first = std::lower_bound(
      all.begin(), all.end(), serial,
      [](const PublishedReading& reading, Serial wanted) { return reading.serial < wanted; });
  const auto end = std::find_if(
      first, all.end(), [&](const PublishedReading& reading) { return reading.serial != serial; });
  return {first, end};
}

std::uint32_t count_disagreeing(const ReadingSnapshot& snapshot) {
  return static_cast<std::uint32_t>(
      std::count_if(snapshot.readings.begin(), snapshot.readings.end(),
                    [](const PublishedReading& reading) { return reading.disagrees; }));
}

namespace {

void add_property(ReadingSnapshot& snapshot, const Quantity& quantity) {
  const std::string name =
      "reading " + quantity.name + (quantity.unit.empty() ? "" : " (" + quantity.unit + ")");
  snapshot.properties.push_back(name);
  snapshot.properties.push_back("stale " + name);
}

}  // namespace

void reserve(ReadingSnapshot& snapshot, const Settings& settings) {
  snapshot.quantities.resize(snapshot.own_quantity_count);
  snapshot.properties.resize(2 * snapshot.own_quantity_count);
  add_quantities(settings, snapshot.quantities);
  for (std::size_t i = snapshot.own_quantity_count; i < snapshot.quantities.size(); ++i) {
    add_property(snapshot, snapshot.quantities[i]);
  }
  snapshot.own_quantity_count = snapshot.quantities.size();
  snapshot.readings.reserve(count_readings(settings));
}

QuantityIndex number_of(ReadingSnapshot& snapshot, const Quantity& quantity) {
  const auto found = std::find(snapshot.quantities.begin(), snapshot.quantities.end(), quantity);
  const auto number = static_cast<std::uint32_t>(found - snapshot.quantities.begin());
  if (found == snapshot.quantities.end()) {
    snapshot.quantities.push_back(quantity);
    add_property(snapshot, quantity);
  }
  return QuantityIndex{number};
}

}  // namespace etcm::firmware
