// Whether the gateway does what it is there for.
#pragma once

#include "firmware/status/status_sources.h"
#include "firmware/status/text_writer.h"

namespace etcm::firmware {

// True when the mesh can be read, every bus has a node that answered within leave_after (or the
// gateway has not listened for so long), no node is missing, and what changed is published. Else
// writes the reason, one line.
bool is_healthy(const StatusSources& sources, port::Instant now, TextWriter& reason);

}  // namespace etcm::firmware
