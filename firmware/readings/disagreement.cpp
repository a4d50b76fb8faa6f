#include "firmware/readings/disagreement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace etcm::firmware {

namespace {

// Its square does not vanish.
constexpr double least_deviation_of_all = 1e-100;

// A reference follows its residuals with this memory, takes none for farther off than so many
// deviations, and goes no farther than this share of the range of the field.
constexpr double reference_memory_samples = 90;
constexpr double step_deviations_max = 2;
constexpr double followed_share = 0.01;
// It goes farther where the field changes its shape: by so many deviations of the slow changes
// around.
constexpr double followed_roughness = 2;
// Noise of more than this share of the range, known after so many samples, calls for the smoother
// surface: what that bends of the field is less than what it leaves out of the noise.
constexpr double noisy_share = 0.018;
constexpr std::uint32_t noise_samples = 60;
// Residuals below this share of the range are the field's affair, and below that of the value
// those of arithmetic.
constexpr double least_share_of_range = 0.01;
constexpr double least_share_of_value = 1e-9;
// The changes around are rough where the field changes its shape. Slow ones are told from noise by
// a mean over so many samples, and count with this many times their deviation; sudden ones by a
// variance of more than so many usual ones, and the excess counts so many times.
constexpr double slow_samples = 16;
constexpr double slow_noise_variance = 1 / (2 * slow_samples - 1);  // of a mean that forgets so
constexpr double slow_weight = 2;
constexpr double usual_variances = 2;
constexpr double excess_weight = 4;
// The slow part of a sensor's own residuals, less what noise makes of it, counts so many times,
// but for no more than this share of the range: a drift however slow is no wandering for long.
constexpr double wander_weight = 3;
constexpr double wander_share_max = 0.02;
// A node that has moved farther than this share of the way to the nearest one stands elsewhere.
constexpr double same_place_share = 0.1;

double distance_between(const Point& a, const Point& b) {
  return std::hypot(static_cast<double>(a.x - b.x), static_cast<double>(a.y - b.y)) /
         static_cast<double>(subunits_per_unit);
}

}  // namespace

DisagreementWatch::DisagreementWatch(const NearestNodes& nodes, std::uint32_t vertices_max,
                                     std::uint32_t sensors_max, double tolerance)
    : nodes_(&nodes), tolerance_(tolerance), place_of_(vertices_max, no_place) {
  set_room(sensors_max);
}

void DisagreementWatch::set_room(std::uint32_t sensors_max) {
  records_.reserve(sensors_max);
  sorted_.reserve(sensors_max);
}

const Agreement& DisagreementWatch::of(std::uint32_t row) const {
  static const Agreement unknown;
  const Record* const record = record_at(row);
  return record != nullptr ? record->agreement : unknown;
}

void DisagreementWatch::take(const Snapshot& snapshot, std::span<const PlacedSensor> sensors) {
  for (Record& record : records_) record.is_wanted = record.is_surface_current = false;
  const auto node_in = [&](std::uint32_t row) -> const SnapshotVertex* {
    if (row >= place_of_.size() || row >= snapshot.vertices.size()) return nullptr;
    const SnapshotVertex& vertex = snapshot.vertices[row];
    return vertex.kind == VertexKind::node ? &vertex : nullptr;
  };
  for (const auto& [row, definition] : sensors) {
    const SnapshotVertex* const node = node_in(row);
    if (node == nullptr || !has_sensor(row)) continue;
    Record& record = records_[place_of_[row]];
    record.is_wanted = record.serial == node->serial && record.definition == definition &&
                       is_same_place(row, record.point, node->point);
  }
  for (auto place = static_cast<std::uint32_t>(records_.size()); place-- > 0;) {
    if (!records_[place].is_wanted) remove(place);
  }
  for (const auto& [row, definition] : sensors) {
    const SnapshotVertex* const node = node_in(row);
    if (node == nullptr || has_sensor(row)) continue;
    place_of_[row] = static_cast<std::uint32_t>(records_.size());
    records_.emplace_back();
    records_.back().row = row;
    records_.back().serial = node->serial;
    records_.back().definition = definition;
    records_.back().point = node->point;
  }
}

bool DisagreementWatch::is_same_place(std::uint32_t row, const Point& stood,
                                      const Point& point) const {
  const auto around = nodes_->around(row);
  const double room = around.empty() ? 0 : same_place_share * std::hypot(around[0].x, around[0].y);
  return distance_between(stood, point) <= room;
}

// The last one takes its place.
void DisagreementWatch::remove(std::uint32_t place) {
  place_of_[records_[place].row] = no_place;
  if (place + 1 != records_.size()) {
    records_[place] = records_.back();
    place_of_[records_[place].row] = place;
  }
  records_.pop_back();
}

void DisagreementWatch::forget(std::uint32_t row) {
  Record& record = records_[place_of_[row]];
  const Record old = record;
  record = {};
  record.row = old.row;
  record.serial = old.serial;
  record.definition = old.definition;
  record.point = old.point;
}

void DisagreementWatch::observe(std::span<const double> values) {
  for (Record& record : records_) {
    record.value = record.row < values.size() && is_value(values[record.row]) ? values[record.row]
                                                                              : no_evidence;
    record.silent_samples = std::isnan(record.value) ? record.silent_samples + 1 : 0;
  }
  find_range();
  find_noise();
  for (Record& record : records_) {
    const bool is_evidence =
        !std::isnan(record.value) && record.reference.has_begun() && !record.agreement.disagrees;
    record.change = is_evidence ? record.value - record.reference.value() : no_evidence;
    if (!is_evidence) continue;
    double& slow = record.slow_change;
    slow = std::isnan(slow) ? record.change : slow + (record.change - slow) / slow_samples;
  }
  // In the order of the rows: what one is judged to be is known to those behind it.
  for (const std::uint32_t place : place_of_) {
    if (place == no_place) continue;
    records_[place].strength = 0;
    if (!std::isnan(records_[place].value)) judge(records_[place]);
  }
  raise_alarms();
}

// Twice the distance between the quartiles: what half of the sensors say cannot change it.
void DisagreementWatch::find_range() {
  sorted_.clear();
  magnitude_ = 0;
  for (const Record& record : records_) {
    if (record.reference.has_begun() && !record.agreement.disagrees) {
      sorted_.push_back(record.reference.value());
    }
  }
  range_ = 0;
  if (sorted_.empty()) return;
  const auto quantile = [&](std::size_t index) {
    const auto place = sorted_.begin() + static_cast<std::ptrdiff_t>(index);
    std::nth_element(sorted_.begin(), place, sorted_.end());
    return *place;
  };
  const std::size_t last = sorted_.size() - 1;
  const double lower = quantile(last / 4);
  const double upper = quantile(last - last / 4);
  range_ = 2 * (upper - lower);
  magnitude_ = std::max(std::abs(lower), std::abs(upper));
}

// By the steps from one value to the next, which the shape of the field has no part in (as Rice
// 1984 takes it): the usual one of all sensors.
void DisagreementWatch::find_noise() {
  sorted_.clear();
  for (Record& record : records_) {
    if (std::isnan(record.value) || record.agreement.disagrees) continue;
    const double step = std::abs(record.value - std::exchange(record.last_value, record.value));
    if (!std::isnan(step)) {
      if (record.step.has_begun()) {
        record.step.add(step, least_deviation() / 100);
      } else {
        record.step.begin(step);
      }
    }
    if (record.step.has_begun()) sorted_.push_back(record.step.deviation());
  }
  if (sorted_.empty()) return;
  const auto middle = sorted_.begin() + static_cast<std::ptrdiff_t>(sorted_.size() / 2);
  std::nth_element(sorted_.begin(), middle, sorted_.end());
  noise_ = *middle / std::numbers::sqrt2;
}

double DisagreementWatch::least_deviation() const {
  return std::max({tolerance_, least_share_of_range * range_, least_share_of_value * magnitude_,
                   least_deviation_of_all});
}

void DisagreementWatch::judge(Record& record) {
  if (!record.reference.has_begun()) return begin_reference(record);
  const auto prediction = predict(record);
  Agreement& agreement = record.agreement;
  agreement.is_judged = prediction && record.sample_count >= learning_samples;
  agreement.expected.reset();
  if (!prediction) return;
  double residual = record.value - record.reference.value() - prediction->change;
  if (record.takes_back) {
    residual = record.reference.take_back(residual);
    record.takes_back = false;
  }
  agreement.expected = record.value - residual;

  const double deviation = deviation_of(record, *prediction);
  agreement.deviation = deviation;
  if (agreement.is_judged) record.cusum.add(residual / deviation);
  agreement.suspicion = record.cusum.sum() / TwoSidedCusum::threshold;
  if (agreement.disagrees) {
    if (record.cusum.is_clear()) {
      agreement.disagrees = false;
      if (record.ended_alarms < ended_alarms_max) ++record.ended_alarms;
    }
    return;
  }
  if (record.cusum.is_beyond()) record.strength = std::abs(residual) / deviation;
  if (!record.cusum.is_suspicious()) learn(record, residual, *prediction);
}

double DisagreementWatch::deviation_of(const Record& record, const Prediction& prediction) const {
  const double own = std::max(record.residual.doubted_deviation(), least_deviation());
  const double slow = slow_weight * prediction.slow_roughness;
  const double usual = record.roughness.value();
  const double excess =
      prediction.roughness * prediction.roughness - usual_variances * usual * usual;
  const double wander = std::min(wander_weight * wander_of(record), wander_share_max * range_);
  return (1 + record.ended_alarms) * std::sqrt(own * own + wander * wander + slow * slow +
                                               excess_weight * std::max(0.0, excess));
}

// A node whose surroundings show too little of the field, at the hull or of a sparse site, has
// residuals that come and go within hours.
double DisagreementWatch::wander_of(const Record& record) const {
  const double slow = record.wander.deviation();
  const double gain = record.surface.noise_gain();
  const double of_noise = slow_noise_variance * noise_ * noise_ * (1 + gain * gain);
  return std::sqrt(std::max(0.0, slow * slow - of_noise));
}

void DisagreementWatch::begin_reference(Record& record) {
  const auto prediction = predict(record);
  const double change = prediction ? prediction->change : mean_change_around(record);
  record.reference.begin_with(record.value - change);
  if (record.reference.has_begun()) record.residual.begin(record.reference.first_difference());
}

void DisagreementWatch::learn(Record& record, double residual, const Prediction& prediction) {
  const double least = least_deviation();
  const double roughness = prediction.roughness;
  if (record.sample_count == 0) {
    record.roughness.begin(roughness);
    record.wander.begin(least / 10);
  }
  // What a changing field does to it is not usual, however long it lasts.
  const bool is_usual = roughness <= std::sqrt(2 * usual_variances) * record.roughness.value();
  if (is_usual || record.sample_count < learning_samples) {
    record.roughness.add(roughness, least / 10);
  }
  record.residual.add(std::abs(residual), least / 10);
  record.slow_residual += (residual - record.slow_residual) / slow_samples;
  record.wander.add(std::abs(record.slow_residual), least / 100);
  const double deviation = std::max(record.residual.doubted_deviation(), least);
  const double gain = 1 / std::min<double>(record.sample_count + 2.0, reference_memory_samples);
  const double step = gain * std::clamp(residual, -step_deviations_max * deviation,
                                        step_deviations_max * deviation);
  if (record.sample_count < learning_samples) {
    record.reference.learn(step);
    if (++record.sample_count == noise_samples && noise_ > noisy_share * range_) {
      record.is_noisy = true;
      record.is_surface_current = false;
      // What was learned is a first guess for the other surface.
      record.residual.begin(record.residual.value());
      record.roughness.begin(record.roughness.value());
    }
  } else {
    record.reference.follow(
        step, followed_share * range_ + followed_roughness * prediction.slow_roughness);
  }
}

std::optional<DisagreementWatch::Prediction> DisagreementWatch::predict(Record& record) {
  const auto around = nodes_->around(record.row);
  std::array<double, thin_plate_max> changes{};
  std::array<double, thin_plate_max> slow_changes{};
  std::size_t count = 0;
  std::uint32_t used = 0;
  std::uint32_t disbelieved = 0;
  for (std::size_t i = 0; i < around.size(); ++i) {
    const Record* const other = record_at(around[i].row);
    if (other == nullptr) continue;
    if (other->agreement.disagrees) disbelieved |= 1u << i;
    if (count == thin_plate_max || std::isnan(other->change)) continue;
    changes[count] = other->change;
    slow_changes[count++] = other->slow_change;
    used |= 1u << i;
  }
  if (record.is_surface_current && (disbelieved & ~record.disbelieved) != 0) {
    record.takes_back = true;
  }
  record.disbelieved = disbelieved;
  if (used != record.used || !record.is_surface_current) {
    std::array<Offset, thin_plate_max> places;
    std::size_t filled = 0;
    for (std::size_t i = 0; i < around.size(); ++i) {
      if ((used >> i & 1u) != 0) places[filled++] = {around[i].x, around[i].y};
    }
    record.has_surface = record.surface.fit(std::span(places).first(count),
                                            record.is_noisy ? noisy_smoothing : usual_smoothing);
    record.used = used;
    record.is_surface_current = true;
  }
  // As many nodes as a plane takes fit whichever of them is wrong.
  if (!record.has_surface || !record.surface.has_deviation()) return std::nullopt;
  const auto values = std::span(changes).first(count);
  const double slow = record.surface.deviation(std::span(slow_changes).first(count));
  const double of_noise = noise_ * record.surface.deviation_of_noise();
  const double slow_excess = slow * slow - slow_noise_variance * of_noise * of_noise;
  return Prediction{record.surface.value(values), record.surface.deviation(values),
                    std::sqrt(std::max(0.0, slow_excess))};
}

double DisagreementWatch::mean_change_around(const Record& record) const {
  double sum = 0;
  int count = 0;
  for (const NearNode& near : nodes_->around(record.row)) {
    const Record* const other = record_at(near.row);
    if (other == nullptr || std::isnan(other->change)) continue;
    sum += other->change;
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

// One at a time among neighbours: the others are judged again without the worst.
void DisagreementWatch::raise_alarms() {
  for (Record& record : records_) {
    if (record.strength == 0) continue;
    const auto around = nodes_->around(record.row);
    const bool is_worst = std::none_of(around.begin(), around.end(), [&](const NearNode& near) {
      const Record* const other = record_at(near.row);
      return other != nullptr && other->strength > record.strength;
    });
    if (is_worst) record.agreement.disagrees = true;
  }
}

}  // namespace etcm::firmware
