// Nodes, units and events as tables for spreadsheets (CSV, RFC 4180): a line of names, then one for
// each.
#pragma once

#include "firmware/status/document.h"
#include "firmware/status/status_sources.h"

namespace etcm::firmware {

inline constexpr const char* csv_media_type = "text/csv; charset=utf-8; header=present";

// Each known node by serial, those of other gateways of a fleet too. O(nodes) for each row.
class NodesCsv final : public Document {
 public:
  // `sources` must outlive this.
  explicit NodesCsv(const StatusSources& sources) : sources_(sources) {}
  bool write_next(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const override;

 private:
  void write_row(const NodeRecord& node, port::Instant asked_at, TextWriter& piece) const;
  void write_whereabouts(const NodeRecord& node, TextWriter& piece) const;

  const StatusSources& sources_;
};

// Each unit that is named in the settings or has ever answered (shown_unit.h).
class UnitsCsv final : public Document {
 public:
  // `sources` must outlive this.
  explicit UnitsCsv(const StatusSources& sources) : sources_(sources) {}
  bool write_next(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const override;

 private:
  void write_row(UnitIndex unit, port::Instant asked_at, TextWriter& piece) const;

  const StatusSources& sources_;
};

// The latest events, the newest first.
class EventsCsv final : public Document {
 public:
  // `sources` must outlive this.
  explicit EventsCsv(const StatusSources& sources) : sources_(sources) {}
  bool write_next(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const override;

 private:
  void write_row(const RecentEvent& event, port::Instant asked_at, TextWriter& piece) const;

  const StatusSources& sources_;
};

}  // namespace etcm::firmware
