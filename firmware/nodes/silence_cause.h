// Why a bus may be silent, for a person.
#pragma once

#include "firmware/logging/text_line.h"
#include "firmware/polling/poller.h"

namespace etcm::firmware {

// What is known of the cause, and what to look at: where there is no link, why; else whether a
// converter, or units that nobody understands, have answered in the last `recent`.
// REQUIRES: none of its units has answered soundly for so long.
TextLine silence_cause(const Poller& poller, BusIndex bus, port::Instant now,
                       port::Duration recent);

}  // namespace etcm::firmware
