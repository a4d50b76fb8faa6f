// The alarms as JSON and as a table: those that are on or have ended lately, the worst first, then
// the others that have ended, the newest first.
#pragma once

#include <cstdint>
#include <string_view>

#include "etcm/port/wall_clock.h"
#include "firmware/alarms/alarm_book.h"
#include "firmware/gateway/gateway.h"
#include "firmware/status/document.h"

namespace etcm::firmware {

// Goes through a book while that changes: none comes twice, and none that is there from the
// beginning to the end is left out, but where it has ended for good meanwhile.
class AlarmWalk {
 public:
  // The next one after what the cursor has, or null.
  static const Alarm* next(const AlarmBook& book, Cursor& cursor, bool wants_ended);
};

// How long ago that was; 0 where it is not known.
port::Duration age_of(const AlarmTime& time, port::Instant asked_at, std::int64_t unix_now_ms);

// Which alarms a document has.
enum class AlarmsShown : std::uint8_t {
  open,           // those that are on or have ended lately
  ended_of_late,  // those that have ended: all lately, and the newest of the others
  all,
};
// So many of those that have ended before, where only the newest are shown.
inline constexpr std::uint32_t ended_of_late_max = 100;

class AlarmsDocument final : public Document {
 public:
  // All must outlive this. Without `gateway` nothing says what an alarm is about.
  AlarmsDocument(const AlarmBook& book, const port::WallClock& wall_clock, AlarmsShown shown,
                 const Gateway* gateway = nullptr)
      : book_(book), wall_clock_(wall_clock), shown_(shown), gateway_(gateway) {}

  bool write_next(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const override;

 private:
  // Null where those that have ended before come to their end.
  const Alarm* next_ended(Cursor& cursor) const;
  // Its name, where it has one.
  void write_site(TextWriter& piece) const;
  void write_alarm(const Alarm& alarm, port::Instant asked_at, TextWriter& piece) const;

  const AlarmBook& book_;
  const port::WallClock& wall_clock_;
  const AlarmsShown shown_;
  const Gateway* const gateway_;
};

// All of them.
class AlarmsCsv final : public Document {
 public:
  // Both must outlive this.
  AlarmsCsv(const AlarmBook& book, const port::WallClock& wall_clock)
      : book_(book), wall_clock_(wall_clock) {}

  bool write_next(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const override;

 private:
  void write_row(const Alarm& alarm, port::Instant asked_at, TextWriter& piece) const;

  const AlarmBook& book_;
  const port::WallClock& wall_clock_;
};

}  // namespace etcm::firmware
