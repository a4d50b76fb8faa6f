// The units of all buses, as JSON: those that are named in the settings or have ever answered.
//
//   "instance"  of the run, as in the other documents
//   "units"     [{"bus": "yard", "unit": 7, "state": "answering", "since_ms": 60000, ...}, ...]
#pragma once

#include "firmware/status/document.h"
#include "firmware/status/status_sources.h"

namespace etcm::firmware {

class UnitsDocument final : public Document {
 public:
  // `sources` must outlive this.
  explicit UnitsDocument(const StatusSources& sources) : sources_(sources) {}
  bool write_next(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const override;

 private:
  void write_unit(UnitIndex unit, port::Instant asked_at, TextWriter& piece) const;

  const StatusSources& sources_;
};

}  // namespace etcm::firmware
