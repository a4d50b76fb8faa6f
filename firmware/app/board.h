// The digital lines of the board that the settings name.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "etcm/port/digital_io.h"
#include "etcm/port/log.h"
#include "firmware/config/settings.h"
#include "firmware/gateway/board_io.h"
#include "posix/event_loop.h"
#ifdef ETCM_WITH_GPIO
#include "gpio/gpio_lines.h"
#endif

namespace etcm::firmware {

class Board {
 public:
  // `loop` and `log` must outlive the board. Throws std::runtime_error where lines are named and
  // the gateway was built without libgpiod.
  Board(const Settings& settings, port::EventLoop& loop, port::Log& log);

  // Null where the settings name no line.
  port::DigitalIo* io();
  // What is not named has none.
  std::optional<port::DigitalLine> line_of(const std::optional<LineSettings>& settings) const;
  BoardLines lines_of(const GpioSettings& settings) const;

 private:
  std::vector<std::string> names_;  // by line
#ifdef ETCM_WITH_GPIO
  std::optional<port::GpioLines> io_;
#endif
};

}  // namespace etcm::firmware
