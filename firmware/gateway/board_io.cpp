#include "firmware/gateway/board_io.h"

#include <algorithm>

#include "firmware/publish/snapshot.h"

namespace etcm::firmware {

std::uint32_t flashes_of(std::uint16_t state, std::uint32_t node_count) {
  if (node_count == 0) return 5;
  if ((state & snapshot_state::budget_hit) != 0) return 4;
  constexpr std::uint16_t silence =
      snapshot_state::stale | snapshot_state::missing | snapshot_state::bus_silent;
  if ((state & silence) != 0) return 3;
  if ((state & snapshot_state::partial) != 0) return 2;
  return 1;
}

BoardIo::BoardIo(port::DigitalIo& io, const BoardLines& lines, Gateway& gateway)
    : io_(io), lines_(lines), gateway_(gateway) {
  if (lines_.watchdog) watchdog_due_ = port::Instant{};
  if (lines_.status_led) led_due_ = port::Instant{};
}

void BoardIo::step(port::Instant now) {
  io_.advance(now);
  const bool is_wanted = is_join_wanted();
  if (is_wanted && join_due_ <= now) {
    gateway_.ask_at_once(default_unit, now);
    join_due_ = now + join_interval;
  }
  was_join_wanted_ = is_wanted;
  if (watchdog_due_ <= now) {
    watchdog_level_ = !watchdog_level_;
    io_.set_active(*lines_.watchdog, watchdog_level_);
    watchdog_due_ = now + watchdog_interval;
  }
  if (led_due_ <= now) show(now);
}

port::Instant BoardIo::next_deadline() const {
  const port::Instant deadline = std::min({io_.next_deadline(), watchdog_due_, led_due_});
  return was_join_wanted_ ? std::min(deadline, join_due_) : deadline;
}

bool BoardIo::is_join_wanted() const {
  return (lines_.alert && io_.is_active(*lines_.alert)) ||
         (lines_.join_button && io_.is_active(*lines_.join_button));
}

// Even edges light the LED, odd ones put it out; a code that has begun is shown to its end.
void BoardIo::show(port::Instant now) {
  if (flash_edges_ == 0) flashes_ = flashes_of(gateway_.state(), gateway_.node_count());
  io_.set_active(*lines_.status_led, flash_edges_ % 2 == 0);
  ++flash_edges_;
  led_due_ = now + flash;
  if (flash_edges_ == 2 * flashes_) {
    flash_edges_ = 0;
    led_due_ = now + flash_pause;
  }
}

}  // namespace etcm::firmware
