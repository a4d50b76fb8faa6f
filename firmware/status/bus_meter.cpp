#include "firmware/status/bus_meter.h"

#include <algorithm>

namespace etcm::firmware {

namespace {

double ratio(port::Duration part, port::Duration whole) {
  return whole.count() == 0
             ? 0
             : static_cast<double>(part.count()) / static_cast<double>(whole.count());
}

}  // namespace

void BusMeter::advance(port::Instant now) {
  buses_.resize(poller_.bus_count());
  if (now < due_) return;
  const bool is_first = looked_at_ == port::Instant{};
  const port::Duration passed = now - looked_at_;
  for (BusIndex number{0}; number.value < buses_.size(); ++number.value) {
    Bus& bus = buses_[number.value];
    const BusCounters& counters = poller_.bus_counters(number);
    if (!is_first) {
      const port::Duration busy = counters.busy - bus.before.busy;
      bus.use.utilisation = ratio(busy, passed);
      // Behind an adapter with a buffer, or on a pty, a line is faster than its speed says.
      bus.use.efficiency = std::min(1.0, ratio(counters.floor - bus.before.floor, busy));
    }
    bus.before = counters;
  }
  looked_at_ = now;
  due_ = now + bus_meter_interval;
}

}  // namespace etcm::firmware
