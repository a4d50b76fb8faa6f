// What the status page and the metrics tell about.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "etcm/port/service_counters.h"
#include "etcm/port/wall_clock.h"
#include "firmware/alarms/alarm_book.h"
#include "firmware/config/settings.h"
#include "firmware/gateway/gateway.h"
#include "firmware/status/bus_meter.h"
#include "firmware/status/recent_events.h"

namespace etcm::firmware {

// All of it must outlive its users.
struct StatusSources {
  const Gateway& gateway;
  const RecentEvents& events;
  const AlarmBook& alarms;
  const port::WallClock& wall_clock;
  const port::ServiceCounters& masters;  // that read registers
  const port::ServiceCounters& readers;  // of the page
  std::string_view version;
  std::string_view config{};  // the path of the settings
  port::Instant started_at{};
  const std::string* refusal = nullptr;  // what reload() said last; null: there is none
  // Keys of the settings that were changed and wait for a restart; null: none.
  const std::vector<std::string>* needs_restart = nullptr;
  const DiskWriter* disk_of_alarms = nullptr;   // null: they are not saved
  std::uint64_t (*resident_bytes)() = nullptr;  // memory of the process; null: not known
  std::uint64_t (*heap_bytes)() = nullptr;      // of it in use from the heap; the same
};

// Tells one run of the gateway from another.
inline std::uint64_t instance_of(const StatusSources& sources) {
  return static_cast<std::uint64_t>(sources.started_at.time_since_epoch().count());
}

}  // namespace etcm::firmware
