#include "firmware/readings/sensor_watch.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>
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

void SensorWatch::update_settings(const Settings& settings) {
  add_quantities(settings, quantities_);
  if (quantities_.empty()) return;
  const SensorCounts counts = count_sensors(settings, quantities_);
  const std::uint32_t vertices = settings.mesh.vertices_max;
  if (watches_.empty()) {
    nodes_ = NearestNodes(vertices, counts.units);
    values_.resize(vertices);
    disagreed_.resize(vertices);
    due_ = {};
  }
  nodes_.set_room(counts.units);
  rows_.reserve(count_readings(settings));
  watches_.reserve(quantities_.size());
  for (std::size_t i = 0; i < quantities_.size(); ++i) {
    if (i == watches_.size()) watches_.emplace_back(nodes_, vertices, counts.by_quantity[i]);
    watches_[i].set_room(counts.by_quantity[i]);
  }
}

void SensorWatch::take(const Snapshot& snapshot, const ReadingSnapshot& readings) {
  if (watches_.empty()) return;
  const auto find_rows = [&](auto is_wanted) {
    rows_.clear();
    for (const PublishedReading& reading : readings.readings) {
      if (reading.row != no_row && is_wanted(reading)) rows_.push_back(reading.row);
    }
  };
  find_rows([](const PublishedReading&) { return true; });
  nodes_.take(snapshot, rows_);
  for (std::uint32_t number = 0; number < watches_.size(); ++number) {
    find_rows([&](const PublishedReading& reading) { return reading.quantity.value == number; });
    watches_[number].take(snapshot, rows_);
  }
}

bool SensorWatch::has_sensors_of(const ReadingSnapshot& readings) const {
  std::size_t count = 0;
  for (const PublishedReading& reading : readings.readings) {
    if (reading.row == no_row) continue;
    if (!watches_[reading.quantity.value].has_sensor(reading.row)) return false;
    ++count;
  }
  return std::accumulate(watches_.begin(), watches_.end(), std::size_t{0},
                         [](std::size_t sum, const DisagreementWatch& watch) {
                           return sum + watch.sensor_count();
                         }) == count;
}

void SensorWatch::observe(const Snapshot& snapshot, const ReadingSnapshot& readings,
                          port::Instant now, port::Log& log) {
  if (!has_sensors_of(readings)) take(snapshot, readings);
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
