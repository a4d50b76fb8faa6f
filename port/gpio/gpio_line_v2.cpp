#include <gpiod.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "gpio/chip_offset.h"
#include "gpio/gpio_line.h"

namespace etcm::port {

namespace {

template <auto release>
struct Release {
  template <class Object>
  void operator()(Object* object) const {
    release(object);
  }
};
template <class Object, auto release>
using Owned = std::unique_ptr<Object, Release<release>>;

using Chip = Owned<gpiod_chip, gpiod_chip_close>;
using ChipInfo = Owned<gpiod_chip_info, gpiod_chip_info_free>;
using Settings = Owned<gpiod_line_settings, gpiod_line_settings_free>;
using LineConfig = Owned<gpiod_line_config, gpiod_line_config_free>;
using RequestConfig = Owned<gpiod_request_config, gpiod_request_config_free>;
using Request = Owned<gpiod_line_request, gpiod_line_request_release>;
using Events = Owned<gpiod_edge_event_buffer, gpiod_edge_event_buffer_free>;

constexpr std::size_t events_at_a_time = 16;

struct Found {
  Chip chip;
  unsigned offset = 0;
};

bool is_chip(gpiod_chip* chip, const std::string& path, const std::string& wanted) {
  const ChipInfo info(gpiod_chip_get_info(chip));
  return path == wanted || (info && (wanted == gpiod_chip_info_get_name(info.get()) ||
                                     wanted == gpiod_chip_info_get_label(info.get())));
}

// The first chip with a line of this name; else CHIP:OFFSET, with the chip's name, label or path.
Found find_line(const std::string& place) {
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::directory_iterator("/dev")) {
    if (entry.path().filename().string().starts_with("gpiochip")) paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  for (const std::string& path : paths) {
    Chip chip(gpiod_chip_open(path.c_str()));
    if (!chip) continue;
    const int offset = gpiod_chip_get_line_offset_from_name(chip.get(), place.c_str());
    if (offset >= 0) return {std::move(chip), static_cast<unsigned>(offset)};
  }
  const auto where = parse_chip_offset(place);
  if (!where) fail_not_found(place);
  for (const std::string& path : paths) {
    Chip chip(gpiod_chip_open(path.c_str()));
    if (chip && is_chip(chip.get(), path, where->chip)) return {std::move(chip), where->offset};
  }
  fail_not_found(place);
}

}  // namespace

struct GpioLine::State {
  Request request;
  Events events;
  unsigned offset = 0;
  bool is_output = false;

  ~State() {
    if (request && is_output) {
      gpiod_line_request_set_value(request.get(), offset, GPIOD_LINE_VALUE_INACTIVE);
    }
  }
};

GpioLine::GpioLine(const LineRequest& request) : state_(std::make_unique<State>()) {
  const Found found = find_line(request.name);
  const Settings settings(gpiod_line_settings_new());
  const LineConfig lines(gpiod_line_config_new());
  const RequestConfig config(gpiod_request_config_new());
  state_->events.reset(gpiod_edge_event_buffer_new(events_at_a_time));
  if (!settings || !lines || !config || !state_->events) fail_request(request.name);
  state_->offset = found.offset;
  state_->is_output = request.use == LineUse::output;
  gpiod_line_settings_set_active_low(settings.get(), request.is_active_low);
  if (state_->is_output) {
    gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_OUTPUT);
    gpiod_line_settings_set_output_value(settings.get(), GPIOD_LINE_VALUE_INACTIVE);
  } else {
    gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_INPUT);
    gpiod_line_settings_set_edge_detection(settings.get(), GPIOD_LINE_EDGE_BOTH);
  }
  gpiod_request_config_set_consumer(config.get(), line_consumer);
  if (gpiod_line_config_add_line_settings(lines.get(), &found.offset, 1, settings.get()) == 0) {
    state_->request.reset(gpiod_chip_request_lines(found.chip.get(), config.get(), lines.get()));
  }
  if (!state_->request) fail_request(request.name);
}

GpioLine::~GpioLine() = default;

std::optional<bool> GpioLine::is_active() const {
  const gpiod_line_value value =
      gpiod_line_request_get_value(state_->request.get(), state_->offset);
  if (value == GPIOD_LINE_VALUE_ERROR) return std::nullopt;
  return value == GPIOD_LINE_VALUE_ACTIVE;
}

bool GpioLine::set_active(bool active) {
  return gpiod_line_request_set_value(
             state_->request.get(), state_->offset,
             active ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE) == 0;
}

int GpioLine::descriptor() const { return gpiod_line_request_get_fd(state_->request.get()); }

bool GpioLine::discard_events() {
  while (gpiod_line_request_wait_edge_events(state_->request.get(), 0) == 1) {
    if (gpiod_line_request_read_edge_events(state_->request.get(), state_->events.get(),
                                            events_at_a_time) < 0) {
      return errno == EINTR || errno == EAGAIN;
    }
  }
  return true;
}

}  // namespace etcm::port
