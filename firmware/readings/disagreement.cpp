#include "firmware/readings/disagreement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace etcm::firmware {

namespace {

// Squares of values, and of the least deviation, neither overflow nor vanish.
constexpr double value_max = 1e100;
constexpr double least_deviation_of_all = 1e-100;

// A reference follows its residuals with this memory, takes none for farther off than so many
// deviations, and goes no farther than this share of the range of the field.
constexpr double reference_memory_samples = 60;
constexpr double step_deviations_max = 2;
constexpr double followed_share = 0.02;
// Residuals below this share of the range are the field's affair, and below that of the value
// those of arithmetic.
constexpr double least_share_of_range = 0.01;
constexpr double least_share_of_value = 1e-9;
// The changes around are rough where the field changes its shape. Slow ones are told from noise by
// a mean over so many samples, and count with this many times their deviation; sudden ones by a
// variance of more than so many usual ones, and the excess counts so many times.
constexpr double slow_samples = 16;
constexpr double slow_weight = 2;
constexpr double usual_variances = 2;
constexpr double excess_weight = 4;
// A node that has moved farther than this share of the way to the nearest one stands elsewhere.
constexpr double same_place_share = 0.1;

constexpr auto seconds_per_sample =
    static_cast<std::uint32_t>(sample_interval / std::chrono::seconds(1));

bool is_value(double value) { return std::abs(value) <= value_max; }

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

LearnedSensor DisagreementWatch::learned_of(const Record& record) {
  LearnedSensor learned;
  learned.serial = record.serial;
  learned.definition = record.definition;
  learned.point = record.point;
  learned.age_s = record.silent_samples * seconds_per_sample;
  learned.sample_count = record.sample_count;
  learned.reference = record.reference.value();
  learned.followed = record.reference.followed();
  learned.has_slow_change = !std::isnan(record.slow_change);
  if (learned.has_slow_change) learned.slow_change = record.slow_change;
  learned.residual = record.residual.median();
  learned.residual_count = record.residual.count();
  learned.roughness = record.roughness.median();
  learned.roughness_count = record.roughness.count();
  learned.rise = record.cusum.rise();
  learned.fall = record.cusum.fall();
  learned.disagrees = record.agreement.disagrees;
  return learned;
}

bool DisagreementWatch::restore(std::uint32_t row, const LearnedSensor& learned) {
  Record& record = records_[place_of_[row]];
  const bool is_new = record.sample_count == 0 && !record.agreement.disagrees;
  const bool makes_sense = is_value(learned.reference) && is_value(learned.followed) &&
                           is_value(learned.slow_change) && is_value(learned.residual) &&
                           learned.residual >= 0 && learned.residual_count > 0 &&
                           is_value(learned.roughness) && learned.roughness >= 0 &&
                           (learned.roughness_count > 0 || learned.sample_count == 0) &&
                           is_value(learned.rise) && is_value(learned.fall);
  const bool is_same = learned.serial == record.serial && learned.definition == record.definition &&
                       is_same_place(row, learned.point, record.point);
  if (!is_new || !makes_sense || !is_same) return false;
  record.silent_samples = learned.age_s / seconds_per_sample;
  record.sample_count = std::min(learned.sample_count, learning_samples);
  record.reference = Reference(learned.reference, learned.followed);
  record.slow_change = learned.has_slow_change ? learned.slow_change : no_evidence;
  record.residual = MedianTracker(learned.residual, learned.residual_count);
  record.roughness = MedianTracker(learned.roughness, learned.roughness_count);
  record.cusum = TwoSidedCusum(learned.rise, learned.fall);
  record.agreement = {};
  // An alarm stands on a sum that is not clear; else it would end only when one has begun again.
  record.agreement.disagrees = learned.disagrees && !record.cusum.is_clear();
  return true;
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
    if (record.cusum.is_clear()) agreement.disagrees = false;
    return;
  }
  if (record.cusum.is_beyond()) record.strength = std::abs(residual) / deviation;
  if (!record.cusum.is_suspicious()) learn(record, residual, prediction->roughness);
}

double DisagreementWatch::deviation_of(const Record& record, const Prediction& prediction) const {
  const double own = std::max(record.residual.deviation(), least_deviation());
  const double slow = slow_weight * prediction.slow_roughness;
  const double usual = record.roughness.median();
  const double excess =
      prediction.roughness * prediction.roughness - usual_variances * usual * usual;
  return std::sqrt(own * own + slow * slow + excess_weight * std::max(0.0, excess));
}

void DisagreementWatch::begin_reference(Record& record) {
  const auto prediction = predict(record);
  const double change = prediction ? prediction->change : mean_change_around(record);
  record.reference.begin_with(record.value - change);
  if (record.reference.has_begun()) record.residual.begin(record.reference.first_difference());
}

void DisagreementWatch::learn(Record& record, double residual, double roughness) {
  const double least = least_deviation();
  if (record.sample_count == 0) record.roughness.begin(roughness);
  // What a changing field does to it is not usual, however long it lasts.
  const bool is_usual = roughness <= std::sqrt(2 * usual_variances) * record.roughness.median();
  if (is_usual || record.sample_count < learning_samples) {
    record.roughness.add(roughness, least / 10);
  }
  record.residual.add(std::abs(residual), least / 10);
  const double deviation = std::max(record.residual.deviation(), least);
  const double gain = 1 / std::min<double>(record.sample_count + 2.0, reference_memory_samples);
  const double step = gain * std::clamp(residual, -step_deviations_max * deviation,
                                        step_deviations_max * deviation);
  if (record.sample_count < learning_samples) {
    record.reference.learn(step);
    ++record.sample_count;
  } else {
    record.reference.follow(step, followed_share * range_);
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
    record.has_surface = record.surface.fit(std::span(places).first(count));
    record.used = used;
    record.is_surface_current = true;
  }
  // As many nodes as a plane takes fit whichever of them is wrong.
  if (!record.has_surface || !record.surface.has_deviation()) return std::nullopt;
  const auto values = std::span(changes).first(count);
  return Prediction{record.surface.value(values), record.surface.deviation(values),
                    record.surface.deviation(std::span(slow_changes).first(count))};
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
