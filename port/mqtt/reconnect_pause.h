// How long to wait before the next attempt to connect: ever longer, up to a bound. Until a
// connection has lasted, somebody is still setting up this end or the other: then the bound is low.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <string_view>

#include "etcm/port/clock.h"
#include "etcm/port/message_broker.h"

namespace etcm::port {

// Each name has lengths of its own, within half as much again: gateways that lost a broker together
// do not all come back to it in one moment.
class ReconnectPause {
 public:
  static constexpr Duration first = std::chrono::seconds(1);
  // And half as much again:
  static constexpr Duration longest = broker_pause_max * 2 / 3;
  static constexpr Duration longest_at_first = std::chrono::seconds(5);

  explicit ReconnectPause(std::string_view name) {
    std::uint32_t hash = 0x811c9dc5u;  // FNV-1a
    for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x01000193u;
    parts_ = (hash ^ hash >> 16) & 0xffu;
  }

  Duration take() {
    const Duration pause = next_ + next_ * parts_ / 512;
    next_ = std::max(next_, std::min(2 * next_, bound_));
    return pause;
  }
  void shorten() { next_ = first; }
  // A connection has lasted.
  void note_lasting() {
    bound_ = longest;
    next_ = first;
  }
  void lengthen() { next_ = longest; }

 private:
  std::int64_t parts_ = 0;  // of 512, that a pause is longer
  Duration next_ = first;
  Duration bound_ = longest_at_first;
};

}  // namespace etcm::port
