// Whether the gateway does what it is there for.
#pragma once

#include "firmware/status/status_sources.h"
#include "firmware/status/text_writer.h"

namespace etcm::firmware {

// True when the mesh can be read, no bus is silent (or has had no answer for leave_after), no node
// is missing, none is far off (but those of whom somebody has acknowledged it), no feature or
// anchor is refused, the broker of its fleet is there and its site is good, what changed is
// published, and the disks take what is to be kept. Else writes all reasons, each on a line of its
// own, the most urgent first.
bool is_healthy(const StatusSources& sources, port::Instant now, TextWriter& reasons);

}  // namespace etcm::firmware
