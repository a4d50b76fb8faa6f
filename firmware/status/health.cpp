#include "firmware/status/health.h"

#include <algorithm>

#include "firmware/nodes/silence_cause.h"
#include "firmware/status/document.h"

namespace etcm::firmware {

namespace {

// What waits longer than this is stuck.
constexpr port::Duration patience = std::chrono::seconds(10);

std::int64_t whole_seconds(port::Duration duration) {
  return std::chrono::floor<std::chrono::seconds>(duration).count();
}

// The first of those that are silent is named.
bool are_buses_heard(const StatusSources& sources, port::Instant now, TextWriter& reason) {
  const Poller& poller = sources.gateway.poller();
  const SilenceClock& clock = sources.gateway.presence().clock();
  const PollSettings& poll = sources.gateway.settings().poll;
  BusIndex first = BusIndex::none();
  std::uint32_t count = 0;
  for (BusIndex bus{0}; bus.value < poller.bus_count(); ++bus.value) {
    if (clock.silence_of(bus) <= poll.leave_after) continue;
    if (count++ == 0) first = bus;
  }
  if (count == 0) return true;
  const port::Duration silence = age_of(std::max(clock.heard_at(first), sources.started_at), now);
  reason << "bus " << bus_label(poller, first) << ": no unit has answered for "
         << whole_seconds(silence) << " s; " << silence_cause(poller, first, now, poll.stale_after);
  if (count > 1) reason << "; and " << count - 1 << " more silent";
  return false;
}

// The one that has been missing for longest is named.
bool is_nobody_missing(const StatusSources& sources, TextWriter& reason) {
  const NodeRecord* first = nullptr;
  std::uint32_t count = 0;
  for (const NodeRecord& node : sources.gateway.nodes().records()) {
    if (!node.is_missing) continue;
    ++count;
    if (first == nullptr || node.heard_at < first->heard_at) first = &node;
  }
  if (first == nullptr) return true;
  const Poller& poller = sources.gateway.poller();
  reason << count << (count == 1 ? " node is" : " nodes are") << " missing: node "
         << first->serial.value;
  if (!first->last_unit.is_none()) {
    reason << ", unit " << poller.address_of(first->last_unit).value << " of "
           << bus_label(poller, poller.bus_of(first->last_unit));
  }
  if (count > 1) reason << ", and " << count - 1 << " more";
  reason << "; look at its power and address, or dismiss it by a reload";
  return false;
}

}  // namespace

bool is_healthy(const StatusSources& sources, port::Instant now, TextWriter& reason) {
  if (!sources.masters.is_listening) {
    reason << "server: nobody can read the mesh; the log says what is wrong with its port";
    return false;
  }
  if (!are_buses_heard(sources, now, reason) || !is_nobody_missing(sources, reason)) return false;
  if (sources.gateway.is_late(now, patience)) {
    reason << "mesh: a change waits to be published; restart the gateway and report it";
    return false;
  }
  return true;
}

}  // namespace etcm::firmware
