// What a DisagreementWatch has learned, as it outlives a restart.
#include <algorithm>
#include <cmath>

#include "firmware/readings/disagreement.h"

namespace etcm::firmware {

namespace {

constexpr auto seconds_per_sample =
    static_cast<std::uint32_t>(sample_interval / std::chrono::seconds(1));

}  // namespace

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
  learned.residual = record.residual.value();
  learned.residual_count = record.residual.count();
  learned.roughness = record.roughness.value();
  learned.roughness_count = record.roughness.count();
  learned.is_noisy = record.is_noisy;
  learned.step = record.step.value();
  learned.step_count = record.step.count();
  learned.slow_residual = record.slow_residual;
  learned.wander = record.wander.value();
  learned.wander_count = record.wander.count();
  learned.rise = record.cusum.rise();
  learned.fall = record.cusum.fall();
  learned.disagrees = record.agreement.disagrees;
  learned.ended_alarms = record.ended_alarms;
  return learned;
}

bool DisagreementWatch::restore(std::uint32_t row, const LearnedSensor& learned) {
  Record& record = records_[place_of_[row]];
  const bool is_new = record.sample_count == 0 && !record.agreement.disagrees;
  const bool makes_sense =
      is_value(learned.reference) && is_value(learned.followed) && is_value(learned.slow_change) &&
      is_value(learned.residual) && learned.residual >= 0 && learned.residual_count > 0 &&
      is_value(learned.roughness) && learned.roughness >= 0 &&
      (learned.roughness_count > 0 || learned.sample_count == 0) && is_value(learned.step) &&
      learned.step >= 0 && is_value(learned.slow_residual) && is_value(learned.wander) &&
      learned.wander >= 0 && (learned.wander_count > 0 || learned.sample_count == 0) &&
      is_value(learned.rise) && is_value(learned.fall);
  const bool is_same = learned.serial == record.serial && learned.definition == record.definition &&
                       is_same_place(row, learned.point, record.point);
  if (!is_new || !makes_sense || !is_same) return false;
  record.silent_samples = learned.age_s / seconds_per_sample;
  record.sample_count = std::min(learned.sample_count, learning_samples);
  record.reference = Reference(learned.reference, learned.followed);
  record.slow_change = learned.has_slow_change ? learned.slow_change : no_evidence;
  record.residual.begin(learned.residual, learned.residual_count);
  record.roughness.begin(learned.roughness, learned.roughness_count);
  record.is_noisy = learned.is_noisy;
  record.is_surface_current = false;
  record.step.begin(learned.step, learned.step_count);
  record.slow_residual = learned.slow_residual;
  record.wander.begin(learned.wander, learned.wander_count);
  record.cusum = TwoSidedCusum(learned.rise, learned.fall);
  record.ended_alarms = std::min(learned.ended_alarms, ended_alarms_max);
  record.agreement = {};
  // An alarm stands on a sum that is not clear; else it would end only when one has begun again.
  record.agreement.disagrees = learned.disagrees && !record.cusum.is_clear();
  return true;
}

}  // namespace etcm::firmware
