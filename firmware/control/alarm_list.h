// The alarms as a person reads them in a terminal.
#pragma once

#include "firmware/status/alarms_document.h"
#include "firmware/status/status_sources.h"

namespace etcm::firmware {

class AlarmList final : public Document {
 public:
  // All must outlive this. Without `sources` the alarms that are on and those that have ended; with
  // them those that are on, and what is no alarm: settings that wait for a restart, doubts.
  AlarmList(const AlarmBook& book, const port::WallClock& wall_clock,
            const StatusSources* sources = nullptr)
      : book_(book), wall_clock_(wall_clock), sources_(sources) {}

  bool write_next(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const override;

 private:
  // Null behind the last.
  const Alarm* next_ended_lately(Cursor& cursor) const;
  void write_head(port::Instant asked_at, TextWriter& piece) const;
  void write_counts(bool has_doubts, TextWriter& piece) const;
  void write_needs_restart(TextWriter& piece) const;
  void write_alarm(const Alarm& alarm, port::Instant asked_at, TextWriter& piece) const;

  const AlarmBook& book_;
  const port::WallClock& wall_clock_;
  const StatusSources* const sources_;
};

}  // namespace etcm::firmware
