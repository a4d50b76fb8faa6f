#include "firmware/readings/sensor_watch.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

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

// Sensors of another gateway are its own business.
bool is_watched(const PublishedReading& reading) {
  return reading.row != no_row && reading.is_own();
}

std::pair<QuantityIndex, Serial> key_of(const LearnedSensor& learned) {
  return {learned.quantity, learned.serial};
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
  learned_max_ = count_readings(settings);
  rows_.reserve(learned_max_);
  sensors_.reserve(learned_max_);
  watches_.reserve(quantities_.size());
  for (std::size_t i = 0; i < quantities_.size(); ++i) {
    if (i == watches_.size()) watches_.emplace_back(nodes_, vertices, counts.by_quantity[i]);
    watches_[i].set_room(counts.by_quantity[i]);
  }
}

void SensorWatch::take(const Snapshot& snapshot, const ReadingSnapshot& readings) {
  if (watches_.empty()) return;
  rows_.clear();
  for (const PublishedReading& reading : readings.readings) {
    if (is_watched(reading)) rows_.push_back(reading.row);
  }
  nodes_.take(snapshot, rows_);
  for (std::uint32_t number = 0; number < watches_.size(); ++number) {
    sensors_.clear();
    for (const PublishedReading& reading : readings.readings) {
      if (reading.quantity.value != number || !is_watched(reading)) continue;
      sensors_.push_back({.row = reading.row, .definition = reading.definition});
    }
    watches_[number].take(snapshot, sensors_);
  }
}

void SensorWatch::restore(std::span<const LearnedSensor> learned,
                          std::span<const Quantity> quantities, port::Duration passed,
                          port::Instant now) {
  restored_at_ = now;
  for (const LearnedSensor& each : learned) {
    if (waiting_.size() == learned_max_) break;
    const Quantity& quantity = quantities[each.quantity.value];
    const auto known = std::find(quantities_.begin(), quantities_.end(), quantity);
    const port::Duration age =
        std::chrono::seconds(each.age_s) + std::max<port::Duration>(passed, {});
    if (known == quantities_.end() || age > learned_age_max) continue;
    waiting_.push_back({.learned = each});
    LearnedSensor& kept = waiting_.back().learned;
    kept.quantity = QuantityIndex{static_cast<std::uint32_t>(known - quantities_.begin())};
    kept.age_s = static_cast<std::uint32_t>(age / std::chrono::seconds(1));
  }
  std::stable_sort(waiting_.begin(), waiting_.end(), [](const Waiting& a, const Waiting& b) {
    return key_of(a.learned) < key_of(b.learned);
  });
}

port::Duration SensorWatch::age_of(const Waiting& waiting, port::Instant now) const {
  return std::chrono::seconds(waiting.learned.age_s) + (now - restored_at_);
}

// Each is tried once, as soon as its sensor is there.
void SensorWatch::take_waiting(const ReadingSnapshot& readings, port::Instant now) {
  for (const PublishedReading& reading : readings.readings) {
    if (!is_watched(reading) || reading.is_stale) continue;
    const std::pair key(reading.quantity, reading.serial);
    const auto found = std::lower_bound(waiting_.begin(), waiting_.end(), key,
                                        [](const Waiting& waiting, const auto& wanted) {
                                          return key_of(waiting.learned) < wanted;
                                        });
    if (found == waiting_.end() || key_of(found->learned) != key || found->is_taken) continue;
    found->is_taken = true;
    if (age_of(*found, now) > learned_age_max) continue;
    static_cast<void>(watches_[reading.quantity.value].restore(reading.row, found->learned));
  }
}

bool SensorWatch::has_sensors_of(const ReadingSnapshot& readings) const {
  std::size_t count = 0;
  for (const PublishedReading& reading : readings.readings) {
    if (!is_watched(reading)) continue;
    if (!watches_[reading.quantity.value].has_sensor(reading.row)) return false;
    ++count;
  }
  return std::accumulate(watches_.begin(), watches_.end(), std::size_t{0},
                         [](std::size_t sum, const DisagreementWatch& watch) {
                           return sum + watch.sensor_count();
                         }) == count;
}

void SensorWatch::observe(const Snapshot& snapshot, const ReadingSnapshot& readings,
                          const NodeTable& nodes, port::Instant now, port::Log& log) {
  if (!has_sensors_of(readings)) take(snapshot, readings);
  take_waiting(readings, now);
  for (std::uint32_t number = 0; number < watches_.size(); ++number) {
    DisagreementWatch& watch = watches_[number];
    std::fill(values_.begin(), values_.end(), std::numeric_limits<double>::quiet_NaN());
    for (const PublishedReading& reading : readings.readings) {
      if (reading.quantity.value != number || !is_watched(reading)) continue;
      disagreed_[reading.row] = watch.of(reading.row).disagrees;
      if (reading.is_stale || !reading.nano || reading.taken_at <= sampled_at_) continue;
      values_[reading.row] = static_cast<double>(*reading.nano) / nano_per_unit;
    }
    watch.observe(values_);
    for (const PublishedReading& reading : readings.readings) {
      if (reading.quantity.value != number || !is_watched(reading)) continue;
      const Agreement& agreement = watch.of(reading.row);
      if (agreement.disagrees == (disagreed_[reading.row] != 0)) continue;
      log_change(reading, readings.quantities[number], agreement, nodes, log);
    }
  }
  has_learned_ = has_learned_ || !readings.readings.empty();
  sampled_at_ = now;
  due_ = now + sample_interval;
  is_news_ = true;
}

void SensorWatch::log_change(const PublishedReading& reading, const Quantity& quantity,
                             const Agreement& agreement, const NodeTable& nodes,
                             port::Log& log) const {
  TextLine line;
  line << nodes.called(reading.serial) << ": its " << quantity.name << " ";
  const std::string who(line.view());
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
    if (!is_watched(reading)) continue;
    const Agreement& agreement = watches_[reading.quantity.value].of(reading.row);
    reading.disagrees = agreement.disagrees;
    if (agreement.expected) reading.expected_nano = to_nano(*agreement.expected);
  }
  if (is_news_) readings.value_sequence = readings.sequence;
  is_news_ = false;
}

}  // namespace etcm::firmware
