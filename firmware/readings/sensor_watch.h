// Watches the sensors of all quantities of a site.
#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "etcm/port/clock.h"
#include "etcm/port/log.h"
#include "firmware/config/settings.h"
#include "firmware/publish/reading_snapshot.h"
#include "firmware/publish/snapshot.h"
#include "firmware/readings/disagreement.h"
#include "firmware/readings/nearest_nodes.h"
#include "firmware/records/node_table.h"

namespace etcm::firmware {

// What was learned of a sensor that has not been read for so long is forgotten: the shape of a
// field changes with the seasons.
inline constexpr port::Duration learned_age_max = std::chrono::hours(24 * 7);

class SensorWatch {
 public:
  // All the memory it needs is taken here: none where nothing is measured, else 1.6 KB for each
  // reading, 0.6 KB for each unit that measures, and for each vertex that there may be 30 bytes and
  // 4 for each quantity.
  explicit SensorWatch(const Settings& settings) { update_settings(settings); }

  // There may be more devices than before, and more quantities behind the others.
  void update_settings(const Settings& settings);

  // Another generation, with the readings of it. O(n) where something is measured, else nothing.
  void take(const Snapshot& snapshot, const ReadingSnapshot& readings);

  // Judges what was read since the last sample, and tells the log who disagrees, and who agrees
  // again. REQUIRES: the rows of `readings` are those of `snapshot`, the generation taken last.
  void observe(const Snapshot& snapshot, const ReadingSnapshot& readings, const NodeTable& nodes,
               port::Instant now, port::Log& log);
  port::Instant next_deadline() const { return due_; }

  // Sets what is expected of each reading. REQUIRES: as above.
  void mark(ReadingSnapshot& readings);

  // Goes on with what an earlier run has learned, which ended so long before: of each sensor once
  // it is read again, where its node stands there still and the profile has it the same. Their
  // quantities are these. Before the first sample; takes memory.
  void restore(std::span<const LearnedSensor> learned, std::span<const Quantity> quantities,
               port::Duration passed, port::Instant now);

  // Visits what is known of the sensors, those of an earlier run included that have not been read
  // again. No more than there are readings in the settings.
  template <class Visit>
  void for_each_learned(port::Instant now, Visit visit) const;
  // Whether there has been a sample since this was asked last.
  bool take_learned() { return std::exchange(has_learned_, false); }

 private:
  // Whether the sensors are those that were taken last.
  bool has_sensors_of(const ReadingSnapshot& readings) const;
  // One of an earlier run.
  struct Waiting {
    LearnedSensor learned;
    bool is_taken = false;
  };
  // How long ago the sensor was read, by now.
  port::Duration age_of(const Waiting& waiting, port::Instant now) const;
  void take_waiting(const ReadingSnapshot& readings, port::Instant now);
  void log_change(const PublishedReading& reading, const Quantity& quantity,
                  const Agreement& agreement, const NodeTable& nodes, port::Log& log) const;

  std::vector<Quantity> quantities_;
  NearestNodes nodes_{0, 0};
  std::vector<DisagreementWatch> watches_;  // by quantity
  std::vector<std::uint32_t> rows_;         // with a sensor: scratch, as the next
  std::vector<PlacedSensor> sensors_;
  std::vector<double> values_;           // by row
  std::vector<std::uint8_t> disagreed_;  // by row, before the sample
  std::uint32_t learned_max_ = 0;
  std::vector<Waiting> waiting_;  // by quantity and serial
  port::Instant restored_at_{};
  bool has_learned_ = false;
  port::Instant sampled_at_{};
  port::Instant due_ = port::never;
  bool is_news_ = false;
};

template <class Visit>
void SensorWatch::for_each_learned(port::Instant now, Visit visit) const {
  std::uint32_t count = 0;
  for (std::uint32_t number = 0; number < watches_.size(); ++number) {
    watches_[number].for_each_learned([&](LearnedSensor learned) {
      learned.quantity = QuantityIndex{number};
      if (count++ < learned_max_) visit(learned);
    });
  }
  for (const Waiting& waiting : waiting_) {
    if (waiting.is_taken || age_of(waiting, now) > learned_age_max) continue;
    LearnedSensor learned = waiting.learned;
    learned.age_s = static_cast<std::uint32_t>(age_of(waiting, now) / std::chrono::seconds(1));
    if (count++ < learned_max_) visit(learned);
  }
}

}  // namespace etcm::firmware
