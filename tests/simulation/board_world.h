// The lines of a board: who presses its button, and what its lamp shows. Written from the guide.
#pragma once

#include <utility>

#include "device.h"
#include "etcm/port/digital_io.h"

namespace etcm::simulation {

class BoardWorld final : public port::DigitalIo {
 public:
  static constexpr port::DigitalLine alert{0}, button{1}, lamp{2}, watchdog{3};
  // The lamp is dark for longer than that between two codes, and within one for less.
  static constexpr Duration within_a_code = std::chrono::milliseconds(500);

  bool is_active(port::DigitalLine input) const override {
    return input.index == alert.index ? is_alerted : is_pressed;
  }
  void set_active(port::DigitalLine output, bool active) override {
    if (output.index == watchdog.index) {
      fed_at = now_;
    } else if (active && !is_lit_) {
      if (now_ - dark_since_ > within_a_code) code = std::exchange(flashes_, 0);
      ++flashes_;
    } else if (!active && is_lit_) {
      dark_since_ = now_;
    }
    if (output.index == lamp.index) is_lit_ = active;
  }
  void advance(Instant now) override { now_ = now; }
  Instant next_deadline() const override { return port::never; }

  bool is_alerted = false;
  bool is_pressed = false;
  std::uint32_t code = 0;  // that was shown last, to its end
  Instant fed_at{};        // the level of the watchdog's line was set

 private:
  Instant now_{};
  bool is_lit_ = false;
  std::uint32_t flashes_ = 0;
  Instant dark_since_{};
};

}  // namespace etcm::simulation
