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
  // All the memory it needs is taken here: none where nothing is measured, else about 1.7 KB
  // for each vertex that there may be and each quantity.
  explicit SensorWatch(const Settings& settings);

  // There may be more quantities than before, behind the others. `snapshot` is the one taken last.
  void update_settings(const Settings& settings, const Snapshot& snapshot);

  // Another generation. O(n) where something is measured, else nothing.
  void take(const Snapshot& snapshot);

  // Judges what was read since the last sample, and tells the log who disagrees, and who agrees
  // again. REQUIRES: the rows of `readings` are those of the generation taken last.
  void observe(const ReadingSnapshot& readings, port::Instant now, port::Log& log);
  port::Instant next_deadline() const { return due_; }

  // Sets what is expected of each reading. REQUIRES: as above.
  void mark(ReadingSnapshot& readings);

 private:
  void log_change(const PublishedReading& reading, const Quantity& quantity,
                  const Agreement& agreement, port::Log& log) const;

  std::vector<Quantity> quantities_;
  NearestNodes nodes_;
  std::vector<DisagreementWatch> watches_;  // by quantity
  std::vector<double> values_;              // by row
  std::vector<std::uint8_t> disagreed_;     // by row, before the sample
  port::Instant sampled_at_{};
  port::Instant due_;
  bool is_news_ = false;
};

}  // namespace etcm::firmware
