#include "firmware/control/doubts.h"

#include <algorithm>
#include <chrono>

#include "firmware/nodes/absent_units.h"
#include "firmware/nodes/faulty_units.h"
#include "firmware/status/shown_unit.h"

namespace etcm::firmware {

namespace {

bool is_in_doubt(const StatusSources& sources, UnitIndex unit, port::Instant now) {
  const Poller& poller = sources.gateway.poller();
  const UnitCounters& counters = poller.counters(unit);
  // The bus may just have been closed, or nobody was asked yet.
  if (counters.last_fault == UnitFault::none) return false;
  if (is_answering(sources.gateway, unit)) return false;
  // The other `units` of a bus may be there or not.
  const NodeRecord* const node = sources.gateway.nodes().at(unit);
  const bool is_expected = counters.has_answered() || node != nullptr ||
                           is_named(sources.gateway.settings(), poller, unit);
  if (!is_expected) return false;
  const port::Instant sound_at = std::max(counters.sound_at, sources.started_at);
  if (now - sound_at > sources.gateway.settings().poll.leave_after) return false;
  return node == nullptr || !node->has_asked_to_leave();
}

}  // namespace

Doubts doubts_of(const StatusSources& sources, port::Instant now) {
  Doubts doubts;
  const std::uint32_t count = sources.gateway.poller().unit_count();
  for (UnitIndex unit{0}; unit.value < count; ++unit.value) {
    if (is_in_doubt(sources, unit, now) && doubts.count++ == 0) doubts.first = unit;
  }
  return doubts;
}

void write_doubts(const StatusSources& sources, const Doubts& doubts, TextWriter& text) {
  if (doubts.count == 0) return;
  const Poller& poller = sources.gateway.poller();
  const UnitFault fault = poller.counters(doubts.first).last_fault;
  text << "no alarm yet: ";
  if (is_of_an_answer(fault)) {
    text << explain_fault(poller, doubts.first).what.view();
  } else {
    text << poller.name(doubts.first) << " does not answer (" << to_string(fault) << ")";
  }
  if (doubts.count > 1) text << "; and " << doubts.count - 1 << " more";
  const port::Duration patience = sources.gateway.settings().poll.leave_after;
  text << "; an alarm tells it after " << std::chrono::ceil<std::chrono::seconds>(patience).count()
       << " s\n";
}

}  // namespace etcm::firmware
