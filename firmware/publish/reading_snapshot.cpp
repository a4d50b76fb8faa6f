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

void reserve(ReadingSnapshot& snapshot, const Settings& settings) {
  const std::size_t known = snapshot.quantities.size();
  add_quantities(settings, snapshot.quantities);
  for (std::size_t i = known; i < snapshot.quantities.size(); ++i) {
    const Quantity& quantity = snapshot.quantities[i];
    const std::string name =
        "reading " + quantity.name + (quantity.unit.empty() ? "" : " (" + quantity.unit + ")");
    snapshot.properties.push_back(name);
    snapshot.properties.push_back("stale " + name);
  }
  snapshot.readings.reserve(count_readings(settings));
}

}  // namespace etcm::firmware
