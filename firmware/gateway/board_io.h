// What the board's lines have to do with the gateway: a node is to join, the state is shown, and
// that it is alive.
#pragma once

#include <cstdint>
#include <optional>

#include "etcm/port/digital_io.h"
#include "firmware/gateway/gateway.h"

namespace etcm::firmware {

struct BoardLines {
  std::optional<port::DigitalLine> alert;        // up while a new node waits at the default address
  std::optional<port::DigitalLine> join_button;  // the same, by hand
  std::optional<port::DigitalLine> status_led;
  std::optional<port::DigitalLine> watchdog;
};

// The default address is asked when the alert goes up, and while it is up: at the most this often,
// however it flutters.
inline constexpr port::Duration join_interval = std::chrono::seconds(1);

// The watchdog line changes its level this often, as long as step() is called.
inline constexpr port::Duration watchdog_interval = std::chrono::milliseconds(500);

// A status is so many short flashes and a pause.
inline constexpr port::Duration flash = std::chrono::milliseconds(150);
inline constexpr port::Duration flash_pause = std::chrono::milliseconds(900);

// The number of flashes: 1 all well, 2 partial, 3 stale or missing, 4 room or budget too small, 5
// no nodes. Of several the highest.
std::uint32_t flashes_of(std::uint16_t snapshot_state, std::uint32_t node_count);

class BoardIo {
 public:
  // `io` and `gateway` must outlive the board.
  BoardIo(port::DigitalIo& io, const BoardLines& lines, Gateway& gateway);

  void step(port::Instant now);
  port::Instant next_deadline() const;

 private:
  bool is_join_wanted() const;
  void show(port::Instant now);

  port::DigitalIo& io_;
  const BoardLines lines_;
  Gateway& gateway_;
  port::Instant join_due_{};
  bool was_join_wanted_ = false;
  bool watchdog_level_ = false;
  port::Instant watchdog_due_ = port::never;
  std::uint32_t flashes_ = 0;
  std::uint32_t flash_edges_ = 0;  // of this round, done
  port::Instant led_due_ = port::never;
};

}  // namespace etcm::firmware
