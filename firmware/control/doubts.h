// What is about to become an alarm unless it mends itself.
#pragma once

#include <cstdint>

#include "firmware/polling/indices.h"
#include "firmware/status/status_sources.h"
#include "firmware/status/text_writer.h"

namespace etcm::firmware {

// Units that are expected, and asked in vain for no longer than leave_after yet. Who has said that
// it leaves is none of them.
struct Doubts {
  UnitIndex first = UnitIndex::none();
  std::uint32_t count = 0;
};
// O(u) for u units.
Doubts doubts_of(const StatusSources& sources, port::Instant now);

// On a line that names the first; nothing where there is none.
void write_doubts(const StatusSources& sources, const Doubts& doubts, TextWriter& text);

}  // namespace etcm::firmware
