// What was learned of one sensor by how it differs from the nodes around it (readings/README.md):
// as much as it takes to go on after a restart.
#pragma once

#include <cstdint>

#include "etcm/types.h"
#include "firmware/polling/indices.h"
#include "firmware/protocol/serial.h"

namespace etcm::firmware {

struct LearnedSensor {
  Serial serial;  // of its node
  QuantityIndex quantity;
  std::uint64_t definition = 0;  // of what it measures: profile/fingerprint.h
  Point point;                   // where the node stood
  std::uint32_t age_s = 0;       // since it was read last
  std::uint32_t sample_count = 0;
  // In the unit of the quantity.
  double reference = 0;
  double followed = 0;  // of that, since it was learned
  bool has_slow_change = false;
  double slow_change = 0;
  double slow_residual = 0;
  // Quantiles, of so many samples.
  double residual = 0;
  double roughness = 0;
  double step = 0;
  double wander = 0;
  std::uint32_t residual_count = 0;
  std::uint32_t roughness_count = 0;
  std::uint32_t step_count = 0;
  std::uint32_t wander_count = 0;
  bool is_noisy = false;  // the smoother surface predicts it
  // The cumulative sums, and whether the alarm stands.
  double rise = 0;
  double fall = 0;
  bool disagrees = false;
  std::uint8_t ended_alarms = 0;  // as far as they count
  friend bool operator==(const LearnedSensor&, const LearnedSensor&) = default;
};

}  // namespace etcm::firmware
