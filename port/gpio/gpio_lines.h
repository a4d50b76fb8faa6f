// DigitalIo with libgpiod: all lines are requested once, and given back inactive.
//
// Inputs are levels: an event only says that it is time to read the line, so that no lost event
// matters; and they are read every `reread_interval` in any case. An input that goes away with its
// chip is inactive from then on, and the log has a line.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "etcm/port/digital_io.h"
#include "etcm/port/log.h"
#include "gpio/debounce.h"
#include "gpio/gpio_line.h"
#include "posix/event_loop.h"

namespace etcm::port {

class GpioLines final : public DigitalIo {
 public:
  static constexpr Duration reread_interval = std::chrono::seconds(1);

  // Line{i} is requests[i]. Throws std::runtime_error (see gpio_line.h). `loop` and `log` must
  // outlive this.
  GpioLines(EventLoop& loop, Log& log, std::span<const LineRequest> requests, Duration debounce);
  ~GpioLines();
  GpioLines(const GpioLines&) = delete;
  GpioLines& operator=(const GpioLines&) = delete;

  bool is_active(Line input) const override;
  void set_active(Line output, bool active) override;
  void advance(Instant now) override;
  Instant next_deadline() const override;

 private:
  class Input;

  std::vector<std::unique_ptr<GpioLine>> lines_;
  std::vector<std::unique_ptr<Input>> inputs_;  // by line; null for an output
  bool has_input_ = false;
  Instant reread_at_{};
};

}  // namespace etcm::port
