// The book of alarms on the disk: it outlives a restart.
#pragma once

#include <cstdint>
#include <vector>

#include "etcm/port/log.h"
#include "etcm/port/store.h"
#include "etcm/port/wall_clock.h"
#include "firmware/alarms/alarm_book.h"
#include "firmware/persist/disk_writer.h"

namespace etcm::firmware {

// No more than so many bytes a second are written for longer, some 17 MB a day: flash memory wears.
// A short book is saved within the minute, a full one every few hours, and each at the end. What
// a person has acknowledged is saved at once. What failed is tried again sooner.
inline constexpr std::int64_t alarm_bytes_per_s = 200;
inline constexpr port::Duration alarm_retry_max = std::chrono::minutes(5);

class AlarmKeeper {
 public:
  // All must outlive this.
  AlarmKeeper(AlarmBook& book, port::Store& store, const port::WallClock& wall_clock,
              port::Log& log);

  // Before the first look.
  void restore(port::Instant now);
  void step(port::Instant now);
  port::Instant next_deadline() const { return disk_.next_deadline(); }
  const DiskWriter& disk() const { return disk_; }
  // The last save, unless one is under way.
  void finish(port::Instant now);

 private:
  void save(port::Instant now);

  AlarmBook& book_;
  port::Store& store_;
  const port::WallClock& wall_clock_;
  port::Log& log_;
  DiskWriter disk_;
  port::Duration interval_{};  // by what was saved last
  std::vector<std::byte> bytes_;
  std::uint32_t saved_events_ = 0;
  std::uint32_t saved_acknowledged_ = 0;
};

}  // namespace etcm::firmware
