// What the status page and the metrics tell about.
#pragma once

#include <cstdint>
#include <string_view>

#include "etcm/port/service_counters.h"
#include "firmware/config/settings.h"
#include "firmware/gateway/gateway.h"
#include "firmware/status/bus_meter.h"
#include "firmware/status/recent_events.h"

namespace etcm::firmware {

// All of it must outlive its users.
struct StatusSources {
  const Gateway& gateway;
  const RecentEvents& events;
  const port::ServiceCounters& masters;  // that read registers
  const port::ServiceCounters& readers;  // of the page
  std::string_view version;
  port::Instant started_at{};
  std::uint64_t (*resident_bytes)() = nullptr;  // memory of the process; null: not known
};

// Tells one run of the gateway from another.
inline std::uint64_t instance_of(const StatusSources& sources) {
  return static_cast<std::uint64_t>(sources.started_at.time_since_epoch().count());
}

}  // namespace etcm::firmware
