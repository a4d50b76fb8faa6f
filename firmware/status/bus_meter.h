// How well the buses are used, over the last while.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "etcm/port/utf8.h"
#include "firmware/polling/poller.h"

namespace etcm::firmware {

// As much of its name as every document has room for.
inline std::string_view bus_label(const Poller& poller, BusIndex bus) {
  constexpr std::size_t shown_max = 200;
  return port::cut_utf8(poller.bus(bus).name, shown_max);
}

inline constexpr port::Duration bus_meter_interval = std::chrono::seconds(10);

struct BusUse {
  double utilisation = 0;  // part of the time in which a question was under way
  double efficiency = 0;   // of that time, what its bytes need at least; 0 where that is not known
};

class BusMeter {
 public:
  // `poller` must outlive this.
  explicit BusMeter(const Poller& poller) : poller_(poller), buses_(poller.bus_count()) {}

  void advance(port::Instant now);
  port::Instant next_deadline() const { return due_; }

  // Of the last whole interval; nothing of a bus that was added since advance().
  BusUse use(BusIndex bus) const {
    return bus.value < buses_.size() ? buses_[bus.value].use : BusUse{};
  }

 private:
  struct Bus {
    BusCounters before;
    BusUse use;
  };

  const Poller& poller_;
  std::vector<Bus> buses_;
  port::Instant looked_at_{};
  port::Instant due_{};
};

}  // namespace etcm::firmware
