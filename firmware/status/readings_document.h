// What the nodes measure, as JSON: small and asked often, so that the mesh need not be.
//
//   "sequence"    of this table; with "generation" of the mesh it goes with
//   "quantities"  [{"name": "level", "unit": "m"}, ...]
//   "names"       [[serial, what people call the node], ...], of those that have a name
//   "readings"    [[serial, index of its quantity, value, age in ms, is stale], ...]
// A value is exact, and null where the device has no valid one. One that is stale is the last
// known.
#pragma once

#include "firmware/publish/reading_snapshot.h"
#include "firmware/publish/snapshot.h"
#include "firmware/status/document.h"

namespace etcm::firmware {

class ReadingsDocument final : public Document {
 public:
  // Both must outlive this, and change only while nobody reads.
  ReadingsDocument(const Snapshot& mesh, const ReadingSnapshot& readings, std::uint64_t instance)
      : mesh_(mesh), readings_(readings), instance_(instance) {}

  bool write_next(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const override;

 private:
  void write_name(Cursor& cursor, TextWriter& piece) const;

  const Snapshot& mesh_;
  const ReadingSnapshot& readings_;
  const std::uint64_t instance_;
};

}  // namespace etcm::firmware
