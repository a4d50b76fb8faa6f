// The alarms as a person reads them in a terminal.
#pragma once

#include "firmware/status/alarms_document.h"

namespace etcm::firmware {

class AlarmList final : public Document {
 public:
  // All must outlive this. `wants_ended`: those that have ended too. `needs_restart`: keys of the
  // settings that wait for one; or null.
  AlarmList(const AlarmBook& book, const port::WallClock& wall_clock, bool wants_ended,
            const std::vector<std::string>* needs_restart = nullptr)
      : book_(book),
        wall_clock_(wall_clock),
        wants_ended_(wants_ended),
        needs_restart_(needs_restart) {}

  bool write_next(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const override;

 private:
  // Null behind the last.
  const Alarm* next_ended_lately(Cursor& cursor) const;
  void write_head(TextWriter& piece) const;
  void write_counts(TextWriter& piece) const;
  void write_needs_restart(TextWriter& piece) const;
  void write_alarm(const Alarm& alarm, port::Instant asked_at, TextWriter& piece) const;

  const AlarmBook& book_;
  const port::WallClock& wall_clock_;
  const bool wants_ended_;
  const std::vector<std::string>* needs_restart_;
};

}  // namespace etcm::firmware
