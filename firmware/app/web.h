// The status page and its server.
#pragma once

#include "etcm/port/clock.h"
#include "etcm/port/log.h"
#include "etcm/port/service_counters.h"
#include "firmware/app/port_report.h"
#include "firmware/config/settings.h"
#include "firmware/status/status_page.h"
#include "http/web_server.h"
#include "posix/event_loop.h"

namespace etcm::firmware {

class Web {
 public:
  // All arguments but `settings` must outlive this, and so must what `sources` names.
  Web(const HttpSettings& settings, const StatusSources& sources, port::ServiceCounters& counters,
      port::EventLoop& loop, port::Log& log);

  // Who may look, and by which names, from now on.
  void update(const HttpSettings& settings);

  void step(port::Instant now);
  port::Instant next_deadline() const;

 private:
  port::Log& log_;
  StatusPage page_;
  port::WebServer server_;
  PortReport report_;
};

}  // namespace etcm::firmware
