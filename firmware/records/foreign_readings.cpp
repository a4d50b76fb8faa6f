#include "firmware/records/foreign_readings.h"

#include <algorithm>

namespace etcm::firmware {

void ForeignReadings::take(Serial serial, std::span<const NamedReading> readings,
                           port::Instant taken_at, bool is_stale) {
  if (readings.empty()) return drop(serial);
  Node& node = nodes_[serial];
  node.readings.clear();
  for (const NamedReading& reading : readings) {
    if (const auto number = number_of(reading.quantity)) {
      node.readings.push_back({.quantity = *number, .nano = reading.nano});
    }
  }
  node.taken_at = taken_at;
  node.is_stale = is_stale;
  has_news_ = true;
}

void ForeignReadings::drop(Serial serial) {
  if (nodes_.erase(serial) > 0) has_news_ = true;
}

std::optional<std::uint32_t> ForeignReadings::number_of(const Quantity& quantity) {
  const auto found = std::find(quantities_.begin(), quantities_.end(), quantity);
  const auto number = static_cast<std::uint32_t>(found - quantities_.begin());
  if (found != quantities_.end()) return number;
  if (number == quantities_max_) return std::nullopt;
  quantities_.push_back(quantity);
  return number;
}

}  // namespace etcm::firmware
