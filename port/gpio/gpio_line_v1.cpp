#include <gpiod.h>

#include <array>
#include <ctime>

#include "gpio/chip_offset.h"
#include "gpio/gpio_line.h"

namespace etcm::port {

struct GpioLine::State {
  gpiod_line* line = nullptr;
  bool is_output = false;

  ~State() {
    if (line == nullptr) return;
    if (is_output && gpiod_line_is_requested(line)) gpiod_line_set_value(line, 0);
    gpiod_line_close_chip(line);
  }
};

namespace {

gpiod_line* find_line(const std::string& place) {
  if (gpiod_line* const line = gpiod_line_find(place.c_str())) return line;
  const auto where = parse_chip_offset(place);
  if (!where) return nullptr;
  gpiod_chip* const chip = gpiod_chip_open_lookup(where->chip.c_str());
  if (chip == nullptr) return nullptr;
  gpiod_line* const line = gpiod_chip_get_line(chip, where->offset);
  if (line == nullptr) gpiod_chip_close(chip);
  return line;
}

}  // namespace

GpioLine::GpioLine(const LineRequest& request) : state_(std::make_unique<State>()) {
  state_->line = find_line(request.name);
  if (state_->line == nullptr) fail_not_found(request.name);
  const int flags = request.is_active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0;
  state_->is_output = request.use == LineUse::output;
  const int result =
      state_->is_output
          ? gpiod_line_request_output_flags(state_->line, line_consumer, flags, 0)
          : gpiod_line_request_both_edges_events_flags(state_->line, line_consumer, flags);
  if (result != 0) fail_request(request.name);
}

GpioLine::~GpioLine() = default;

std::optional<bool> GpioLine::is_active() const {
  const int value = gpiod_line_get_value(state_->line);
  return value < 0 ? std::nullopt : std::optional(value == 1);
}

bool GpioLine::set_active(bool active) {
  return gpiod_line_set_value(state_->line, active ? 1 : 0) == 0;
}

int GpioLine::descriptor() const { return gpiod_line_event_get_fd(state_->line); }

bool GpioLine::discard_events() {
  std::array<gpiod_line_event, 16> events;
  const timespec no_wait{};
  while (gpiod_line_event_wait(state_->line, &no_wait) == 1) {
    if (gpiod_line_event_read_multiple(state_->line, events.data(), events.size()) < 0) {
      return errno == EINTR || errno == EAGAIN;
    }
  }
  return true;
}

}  // namespace etcm::port
