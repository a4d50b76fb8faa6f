// How things stand, as JSON for the status page.
#pragma once

#include "firmware/status/document.h"
#include "firmware/status/status_sources.h"

namespace etcm::firmware {

// Counts, state, the fleet, missing nodes, buses and recent events: small, and never the same
// twice.
class StatusDocument final : public Document {
 public:
  StatusDocument(const StatusSources& sources, const BusMeter& meter)
      : sources_(sources), meter_(meter) {}
  bool write_next(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const override;

 private:
  void write_head(port::Instant asked_at, TextWriter& piece) const;
  void write_troubles(port::Instant asked_at, TextWriter& piece) const;
  void write_needs_restart(TextWriter& piece) const;
  void write_plan(TextWriter& piece) const;
  void write_counts(TextWriter& piece) const;
  void write_quarantine(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const;
  void write_why(const QuarantineEntry& entry, TextWriter& piece) const;
  void write_fleet(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const;
  void write_fleet_head(const FleetReport& report, port::Instant asked_at, TextWriter& piece) const;
  void write_member(const ReportedMember& member, port::Instant asked_at,
                    std::string_view separator, TextWriter& piece) const;
  void write_missing(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const;
  void write_left(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const;
  // Of a node that has one, here and below.
  void write_name(Serial serial, TextWriter& piece) const;
  void write_unit(UnitIndex unit, TextWriter& piece) const;
  void write_unheard(Cursor& cursor, TextWriter& piece) const;
  void write_bus(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const;
  void write_event(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const;

  const StatusSources& sources_;
  const BusMeter& meter_;
};

// The age of the last position of each node that has told one: [[serial, milliseconds], ...].
class AgesDocument final : public Document {
 public:
  explicit AgesDocument(const StatusSources& sources) : sources_(sources) {}
  bool write_next(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const override;

 private:
  const StatusSources& sources_;
};

}  // namespace etcm::firmware
