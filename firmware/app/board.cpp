#include "firmware/app/board.h"

#include <algorithm>
#include <cstdint>
#include <stdexcept>

namespace etcm::firmware {

namespace {

// Lines that are named, by their numbers: visit(line, whether it is an output).
template <class Visit>
void for_each_line(const Settings& settings, Visit visit) {
  const auto look_at = [&](const std::optional<LineSettings>& line, bool is_output) {
    if (line) visit(*line, is_output);
  };
  look_at(settings.gpio.alert, false);
  look_at(settings.gpio.join_button, false);
  look_at(settings.gpio.status_led, true);
  look_at(settings.gpio.watchdog, true);
  for (const BusSettings& bus : settings.buses) look_at(bus.send_enable, true);
}

}  // namespace

Board::Board(const Settings& settings, [[maybe_unused]] port::EventLoop& loop,
             [[maybe_unused]] port::Log& log) {
  for_each_line(settings, [&](const LineSettings& line, bool) { names_.push_back(line.name); });
  if (names_.empty()) return;
#ifdef ETCM_WITH_GPIO
  std::vector<port::LineRequest> requests;
  for_each_line(settings, [&](const LineSettings& line, bool is_output) {
    requests.push_back({.name = line.name,
                        .use = is_output ? port::LineUse::output : port::LineUse::input,
                        .is_active_low = line.is_active_low});
  });
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
