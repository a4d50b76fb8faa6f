// DigitalIo with libgpiod: lines are requested at the start, and given back inactive. One that is
// not there, or that another program has, is inactive, switches nothing and is tried again; the log
// has a line.
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
  // Looking for a line opens each chip.
  static constexpr Duration retry_interval = std::chrono::seconds(10);

  // DigitalLine{i} is requests[i]. `loop` and `log` must outlive this.
  GpioLines(EventLoop& loop, Log& log, std::span<const LineRequest> requests, Duration debounce);
  ~GpioLines();
  GpioLines(const GpioLines&) = delete;
  GpioLines& operator=(const GpioLines&) = delete;

  bool is_active(DigitalLine input) const override;
  void set_active(DigitalLine output, bool active) override;
  void advance(Instant now) override;
  Instant next_deadline() const override;

 private:
  class Input;
  struct RequestedLine {
    explicit RequestedLine(LineRequest wanted);
    RequestedLine(RequestedLine&&) noexcept;
    ~RequestedLine();

    LineRequest request;
    std::unique_ptr<GpioLine> gpio_line;  // null while it cannot be had
    std::unique_ptr<Input> input;         // null for an output, and without a line
    bool is_told = false;                 // that it cannot be had, or is gone
  };

  void try_to_open(RequestedLine& requested);
  // Until it is had again: `error` says why it is gone.
  void drop(RequestedLine& requested, int error);
  bool is_any_missing() const;
  bool has_input() const;

  EventLoop& loop_;
  Log& log_;
  const Duration debounce_;
  std::vector<RequestedLine> requested_;  // by line
  Instant reread_at_{};
  Instant retry_at_{};
};

}  // namespace etcm::port
