// Whether the gateway does what it is there for.
#pragma once

#include "status_sources.h"
#include "text_writer.h"

namespace etcm::firmware {

// True when every bus has a unit that answered within leave_after, or the gateway has not run for
// so long. Else writes the reason, one line.
bool is_healthy(const StatusSources& sources, port::Instant now, TextWriter& reason);

}  // namespace etcm::firmware
