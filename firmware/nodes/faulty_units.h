// Units that answer, and nothing of what they say is of use: with exceptions, garbled, or not to be
// believed. Who says nothing at all is missing (presence.h) or absent (absent_units.h).
#pragma once

#include <optional>

#include "etcm/port/clock.h"
#include "firmware/logging/text_line.h"
#include "firmware/polling/poller.h"

namespace etcm::firmware {

// Since when it has had no sound answer, `from` at the earliest, where that is longer than
// `patience`. None for one that is only looked for, and where another node than the one expected
// answers: that is a conflict of identities (identity_conflict.h).
std::optional<port::Instant> faulty_since(const Poller& poller, UnitIndex unit, port::Instant from,
                                          port::Duration patience, port::Instant now);

struct FaultText {
  TextLine what;  // "unit 7 of yard answers with exception 2"
  TextLine cure;
};
// REQUIRES: it is faulty.
FaultText explain_fault(const Poller& poller, UnitIndex unit);

}  // namespace etcm::firmware
