#include "firmware/nodes/silence_cause.h"

namespace etcm::firmware {

TextLine silence_cause(const Poller& poller, BusIndex bus, port::Instant now,
                       port::Duration recent) {
  TextLine line;
  if (const std::string_view why = poller.why_down(bus); !why.empty()) return line << why;
  const BusCounters& counters = poller.bus_counters(bus);
  const auto is_recent = [&](port::Instant at) {
    return at != port::Instant{} && now - at <= recent;
  };
  if (is_recent(counters.heard_at)) {
    return line << "its units answer, but with nothing sound; each has an alarm of its own, or a "
                   "line in the log, that says why";
  }
  if (is_recent(counters.absence_told_at)) {
    return line << "the converter says that nobody is there; check the line behind it, and the "
                   "power and addresses of its units";
  }
  if (std::holds_alternative<port::SerialLine>(poller.bus(bus).link)) {
    return line << "check its cable, speed and parity, and the power and addresses of its units";
  }
  return line << "connected, but nothing answers; check the line behind it, and the power and "
                 "addresses of its units";
}

}  // namespace etcm::firmware
