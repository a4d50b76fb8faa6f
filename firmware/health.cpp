#include "health.h"

#include <algorithm>

namespace etcm::firmware {

namespace {

// What waits longer than this is stuck.
constexpr port::Duration patience = std::chrono::seconds(10);

std::int64_t whole_seconds(port::Duration duration) {
  return std::chrono::floor<std::chrono::seconds>(duration).count();
}

}  // namespace

bool is_healthy(const StatusSources& sources, port::Instant now, TextWriter& reason) {
  if (!sources.masters.is_listening) {
    reason << "server: nobody can read the mesh; the log says what is wrong with its port";
    return false;
  }
  const Poller& poller = sources.gateway.poller();
  for (std::uint32_t bus = 0; bus < poller.bus_count(); ++bus) {
    const port::Instant answered_at = poller.bus_counters(bus).answered_at;
    const port::Duration silence = now - std::max(answered_at, sources.started_at);
    if (silence <= sources.settings.poll.leave_after) continue;
    reason << "bus " << bus_label(poller, bus) << ": no unit has answered for "
           << whole_seconds(silence) << " s; check its cable and power";
    return false;
  }
  if (sources.gateway.is_late(now, patience)) {
    reason << "mesh: a change waits to be published; restart the gateway and report it";
    return false;
  }
  return true;
}

}  // namespace etcm::firmware
