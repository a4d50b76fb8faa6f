#include "firmware/app/board.h"

#include <algorithm>
#include <cstdint>
#include <stdexcept>

namespace etcm::firmware {

Board::Board(const Settings& settings, [[maybe_unused]] port::EventLoop& loop,
             [[maybe_unused]] port::Log& log) {
  std::vector<port::LineRequest> requests;
  const auto want = [&](const std::optional<LineSettings>& line, port::LineUse use) {
    if (!line) return;
    requests.push_back({.name = line->name, .use = use, .is_active_low = line->is_active_low});
    names_.push_back(line->name);
  };
  want(settings.gpio.alert, port::LineUse::input);
  want(settings.gpio.join_button, port::LineUse::input);
  want(settings.gpio.status_led, port::LineUse::output);
  want(settings.gpio.watchdog, port::LineUse::output);
  for (const BusSettings& bus : settings.buses) want(bus.send_enable, port::LineUse::output);
  if (requests.empty()) return;
#ifdef ETCM_WITH_GPIO
  io_.emplace(loop, log, requests, settings.gpio.debounce);
#else
  throw std::runtime_error(
      "the settings name gpio lines, but this gateway was built without libgpiod; install "
      "libgpiod-dev and build it again, or take the lines out");
#endif
}

port::DigitalIo* Board::io() {
#ifdef ETCM_WITH_GPIO
  if (io_) return &*io_;
#endif
  return nullptr;
}

std::optional<port::DigitalLine> Board::line_of(const std::optional<LineSettings>& settings) const {
  if (!settings) return std::nullopt;
  const auto found = std::find(names_.begin(), names_.end(), settings->name);
  if (found == names_.end()) return std::nullopt;
  return port::DigitalLine{static_cast<std::uint8_t>(found - names_.begin())};
}

BoardLines Board::lines_of(const GpioSettings& settings) const {
  return {.alert = line_of(settings.alert),
          .join_button = line_of(settings.join_button),
          .status_led = line_of(settings.status_led),
          .watchdog = line_of(settings.watchdog)};
}

}  // namespace etcm::firmware
