// Takes snapshots of the readings, one after the other into the same memory.
#pragma once

#include <cstdint>
#include <vector>

#include "etcm/port/clock.h"
#include "firmware/config/settings.h"
#include "firmware/publish/reading_snapshot.h"
#include "firmware/publish/snapshot.h"
#include "firmware/records/foreign_readings.h"
#include "firmware/records/node_table.h"
#include "firmware/records/reading_table.h"

namespace etcm::firmware {

class ReadingTaker {
 public:
  // All the memory that it needs for these settings is taken here.
  explicit ReadingTaker(const Settings& settings) { update_settings(settings); }

  // There may be more devices, and quantities, than before.
  void update_settings(const Settings& settings) { reserve(snapshot_, settings); }

  // The readings of all nodes that are known. `mesh` is what was published last. Clears the news of
  // both tables. O(n log n) of the readings. Good until the next call; what is expected of them is
  // to be added.
  ReadingSnapshot& take(ReadingTable& table, ForeignReadings& foreign, const NodeTable& nodes,
                        const Snapshot& mesh, port::Instant now);
  // The one taken last; before, it has quantities only.
  const ReadingSnapshot& latest() const { return snapshot_; }

 private:
  void add_foreign(const ForeignReadings& foreign, const NodeTable& nodes, const Snapshot& mesh);

  ReadingSnapshot snapshot_;
  std::vector<QuantityIndex> foreign_numbers_;  // of the quantities of others
};

}  // namespace etcm::firmware
