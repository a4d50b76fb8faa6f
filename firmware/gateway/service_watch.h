// What the service manager hears: that the gateway is ready, how it is, and that it is alive.
//
// Alive is said only of progress since it was said last: this loop has turned, each bus that had a
// unit to ask has asked or heard something (one whose link is down has nothing to ask), and what
// has changed in the mesh is published. A loop that turns without that is as dead as one that
// hangs.
#pragma once

#include <string>
#include <string_view>

#include "etcm/port/log.h"
#include "etcm/port/service_counters.h"
#include "etcm/port/service_manager.h"
#include "firmware/gateway/gateway.h"

namespace etcm::firmware {

// The status is told at the most so often.
inline constexpr port::Duration status_interval = std::chrono::seconds(2);

// The servers whose ports may not be had.
struct WatchedServers {
  const port::ServiceCounters& masters;
  const port::ServiceCounters& readers;
};

class ServiceWatch {
 public:
  // All arguments must outlive the watch, and so must what `servers` names. `refusal`: what
  // reload() said last.
  ServiceWatch(port::ServiceManager& manager, const Gateway& gateway, const WatchedServers& servers,
               const std::string& refusal, port::Log& log);

  void ready(port::Instant now);
  // After a turn of the gateway.
  void step(port::Instant now);
  port::Instant next_deadline() const;

  // Other settings are being taken over, and then ready().
  void reloading() { manager_.tell(port::ServiceEvent::reloading); }
  void stopping() { manager_.tell(port::ServiceEvent::stopping); }

 private:
  void tell_status(port::Instant now);
  void feed(port::Instant now);
  std::string what_stalls(port::Instant now) const;
  std::string_view what_is_missing() const;
  bool has_news() const;

  port::ServiceManager& manager_;
  const Gateway& gateway_;
  const WatchedServers servers_;
  const std::string& refusal_;
  port::Log& log_;
  const port::Duration feed_interval_;
  port::Instant feed_due_ = port::never;
  port::Instant status_due_ = port::never;
  std::uint32_t delivered_generation_ = 0;
  std::string_view told_missing_;
  bool is_starving_ = false;
};

}  // namespace etcm::firmware
