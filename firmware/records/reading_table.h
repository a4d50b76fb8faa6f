// What the devices measured last, with the node that each was at the time.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "etcm/port/clock.h"
#include "firmware/polling/poller.h"
#include "firmware/protocol/serial.h"

namespace etcm::firmware {

struct ReadingRecord {
  UnitIndex unit_index;
  QuantityIndex quantity;
  std::uint64_t definition = 0;      // by the profile (polling/device.h)
  Serial serial;                     // of the node that measured it; none: nothing was read yet
  std::optional<std::int64_t> nano;  // in 10^-9 of the quantity's unit; none: it was not valid
  port::Instant taken_at{};          // the end of the sweep
  bool is_stale = false;             // no sweep lately
};

// One record for each reading of the device of each unit, in the order of the units: memory is
// taken with the configuration. A record is of its node for as long as that node is known and
// answered at this unit last (NodeRecord::last_unit).
class ReadingTable {
 public:
  explicit ReadingTable(const Poller& poller) { add_units(poller); }

  // The poller may have more units than before. Other records keep their numbers.
  void add_units(const Poller& poller);

  // The readings of a sweep of this unit that is believed.
  // REQUIRES: one for each quantity of the unit, in that order.
  void take(UnitIndex unit, Serial serial, std::span<const Measurement> measured,
            port::Instant now);
  // No sweep has come lately.
  void set_stale(ReadingRecord& record);

  std::span<ReadingRecord> records() { return records_; }
  std::span<const ReadingRecord> records() const { return records_; }

  // Whether anything was taken, or became stale, since has_news was cleared.
  bool has_news() const { return has_news_; }
  void clear_news() { has_news_ = has_other_values_ = false; }
  // Of that, whether anything but the time is another.
  bool has_other_values() const { return has_other_values_; }

 private:
  std::vector<ReadingRecord> records_;
  std::vector<std::uint32_t> first_of_;  // by unit
  bool has_news_ = false;
  bool has_other_values_ = false;
};

}  // namespace etcm::firmware
