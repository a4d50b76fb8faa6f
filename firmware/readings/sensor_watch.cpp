#include "firmware/readings/sensor_watch.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <string>

#include "firmware/polling/quantity.h"

namespace etcm::firmware {

namespace {

constexpr double nano_per_unit = 1e9;

// None where it does not fit.
std::optional<std::int64_t> to_nano(double value) {
  const double scaled = value * nano_per_unit;
  if (!(std::abs(scaled) < 9.2e18)) return std::nullopt;
  return std::llround(scaled);
}

// "1.25 m", as exact as a sensor is.
std::string text_of(double value, const Quantity& quantity) {
  char digits[40];
  std::snprintf(digits, sizeof digits, "%.5g", value);
  return digits + (quantity.unit.empty() ? "" : " " + quantity.unit);
}

}  // namespace

SensorWatch::SensorWatch(const Settings& settings) : nodes_(0), due_(port::never) {
  update_settings(settings, Snapshot{});
}

void SensorWatch::update_settings(const Settings& settings, const Snapshot& snapshot) {
  add_quantities(settings, quantities_);
  if (watches_.size() == quantities_.size()) return;
  if (watches_.empty()) {
    nodes_ = NearestNodes(settings.mesh.vertices_max);
    values_.resize(settings.mesh.vertices_max);
    disagreed_.resize(settings.mesh.vertices_max);
    due_ = {};
  }
  watches_.reserve(quantities_.size());
  while (watches_.size() < quantities_.size()) {
    watches_.emplace_back(nodes_, settings.mesh.vertices_max);
  }
  take(snapshot);
}

void SensorWatch::take(const Snapshot& snapshot) {
  if (watches_.empty()) return;
  nodes_.take(snapshot);
  for (DisagreementWatch& watch : watches_) watch.take(snapshot);
}

void SensorWatch::observe(const ReadingSnapshot& readings, port::Instant now, port::Log& log) {
  for (std::uint32_t number = 0; number < watches_.size(); ++number) {
    DisagreementWatch& watch = watches_[number];
    std::fill(values_.begin(), values_.end(), std::numeric_limits<double>::quiet_NaN());
    for (const PublishedReading& reading : readings.readings) {
      if (reading.quantity.value != number || reading.row == no_row) continue;
      disagreed_[reading.row] = watch.of(reading.row).disagrees;
      if (reading.is_stale || !reading.nano || reading.taken_at <= sampled_at_) continue;
      values_[reading.row] = static_cast<double>(*reading.nano) / nano_per_unit;
    }
    watch.observe(values_);
    for (const PublishedReading& reading : readings.readings) {
      if (reading.quantity.value != number || reading.row == no_row) continue;
      const Agreement& agreement = watch.of(reading.row);
      if (agreement.disagrees == (disagreed_[reading.row] != 0)) continue;
      log_change(reading, readings.quantities[number], agreement, log);
    }
  }
  sampled_at_ = now;
  due_ = now + sample_interval;
  is_news_ = true;
}

void SensorWatch::log_change(const PublishedReading& reading, const Quantity& quantity,
                             const Agreement& agreement, port::Log& log) const {
  const std::string who =
      "node " + std::to_string(reading.serial.value) + ": its " + quantity.name + " ";
  if (!agreement.disagrees) {
    log.write(port::Level::info, who + "agrees with the nodes around it again");
    return;
  }
  const std::string read =
      reading.nano
          ? "of " + text_of(static_cast<double>(*reading.nano) / nano_per_unit, quantity) + " "
          : "";
  const std::string expected =
      agreement.expected ? ", by which it would be " + text_of(*agreement.expected, quantity) : "";
  log.write(port::Level::warning, who + read +
                                      "has disagreed for some minutes with the nodes around it" +
                                      expected + "; look after the sensor");
}

void SensorWatch::mark(ReadingSnapshot& readings) {
  if (watches_.empty()) return;
  for (PublishedReading& reading : readings.readings) {
    if (reading.row == no_row) continue;
    const Agreement& agreement = watches_[reading.quantity.value].of(reading.row);
    reading.disagrees = agreement.disagrees;
    if (agreement.expected) reading.expected_nano = to_nano(*agreement.expected);
  }
  if (is_news_) readings.value_sequence = readings.sequence;
  is_news_ = false;
}

}  // namespace etcm::firmware
