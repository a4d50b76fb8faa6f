// Watches the sensors of all quantities of a site.
#pragma once

#include <cstdint>
#include <vector>

#include "etcm/port/clock.h"
#include "etcm/port/log.h"
#include "firmware/config/settings.h"
#include "firmware/publish/reading_snapshot.h"
#include "firmware/publish/snapshot.h"
#include "firmware/readings/disagreement.h"
#include "firmware/readings/nearest_nodes.h"

namespace etcm::firmware {

// The time between two samples of the site: what the thresholds are meant for.
inline constexpr port::Duration sample_interval = std::chrono::minutes(1);

class SensorWatch {
 public:
  // All the memory it needs is taken here: none where nothing is measured, else 1.5 KB for each
  // reading, 0.6 KB for each unit that measures, and for each vertex that there may be 30 bytes and
  // 4 for each quantity.
  explicit SensorWatch(const Settings& settings) { update_settings(settings); }

  // There may be more devices than before, and more quantities behind the others.
  void update_settings(const Settings& settings);

  // Another generation, with the readings of it. O(n) where something is measured, else nothing.
  void take(const Snapshot& snapshot, const ReadingSnapshot& readings);

  // Judges what was read since the last sample, and tells the log who disagrees, and who agrees
  // again. REQUIRES: the rows of `readings` are those of `snapshot`, the generation taken last.
  void observe(const Snapshot& snapshot, const ReadingSnapshot& readings, port::Instant now,
               port::Log& log);
  port::Instant next_deadline() const { return due_; }

  // Sets what is expected of each reading. REQUIRES: as above.
  void mark(ReadingSnapshot& readings);

 private:
  // Whether the sensors are those that were taken last.
  bool has_sensors_of(const ReadingSnapshot& readings) const;
  void log_change(const PublishedReading& reading, const Quantity& quantity,
                  const Agreement& agreement, port::Log& log) const;

  std::vector<Quantity> quantities_;
  NearestNodes nodes_{0, 0};
  std::vector<DisagreementWatch> watches_;  // by quantity
  std::vector<std::uint32_t> rows_;         // with a sensor: scratch
  std::vector<double> values_;              // by row
  std::vector<std::uint8_t> disagreed_;     // by row, before the sample
  port::Instant sampled_at_{};
  port::Instant due_ = port::never;
  bool is_news_ = false;
};

}  // namespace etcm::firmware
