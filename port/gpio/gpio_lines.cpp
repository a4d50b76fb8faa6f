#include "gpio/gpio_lines.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

namespace etcm::port {

class GpioLines::Input final : private EventHandler {
 public:
  Input(EventLoop& loop, Log& log, GpioLine& line, std::string place, Duration period)
      : loop_(loop),
        log_(log),
        line_(line),
        place_(std::move(place)),
        debounce_(line.is_active(), period) {
    loop_.add(line_.descriptor(), *this, true, false);
  }
  ~Input() {
    if (!is_gone_) loop_.remove(line_.descriptor());
  }
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;

  void read(Instant now) {
    debounce_.sample(line_.is_active(), std::exchange(has_moved_, false), now);
  }
  const Debounce& debounce() const { return debounce_; }
  bool has_moved() const { return has_moved_; }

 private:
  void on_ready(bool, bool) override {
    has_moved_ = true;
    if (line_.discard_events()) return;
    const int error = errno;
    // Nobody could wait for it: it is ready all the time.
    is_gone_ = true;
    loop_.remove(line_.descriptor());
    log_.write(Level::warning, "gpio line " + place_ + " is gone (" + std::strerror(error) +
                                   "); goes on without it; plug its chip in again, and restart");
  }

  EventLoop& loop_;
  Log& log_;
  GpioLine& line_;
  const std::string place_;
  bool is_gone_ = false;
  Debounce debounce_;
  bool has_moved_ = false;
};

GpioLines::Place::Place(LineRequest wanted) : request(std::move(wanted)) {}
GpioLines::Place::Place(Place&&) noexcept = default;
GpioLines::Place::~Place() = default;

GpioLines::GpioLines(EventLoop& loop, Log& log, std::span<const LineRequest> requests,
                     Duration debounce)
    : loop_(loop), log_(log), debounce_(debounce) {
  for (const LineRequest& request : requests) try_to_open(places_.emplace_back(request));
}

GpioLines::~GpioLines() = default;

void GpioLines::try_to_open(Place& place) {
  try {
    place.line = std::make_unique<GpioLine>(place.request);
  } catch (const std::runtime_error& error) {
    if (std::exchange(place.is_told, true)) return;
    log_.write(Level::error, std::string(error.what()) + "; goes on without it, and tries again");
    return;
  }
  if (place.request.use == LineUse::input) {
    place.input = std::make_unique<Input>(loop_, log_, *place.line, place.request.place, debounce_);
  }
  if (place.is_told) log_.write(Level::info, "gpio line " + place.request.place + " is there");
}

bool GpioLines::is_any_missing() const {
  return std::any_of(places_.begin(), places_.end(),
                     [](const Place& place) { return place.line == nullptr; });
}

bool GpioLines::has_input() const {
  return std::any_of(places_.begin(), places_.end(),
                     [](const Place& place) { return place.input != nullptr; });
}

bool GpioLines::is_active(Line input) const {
  const Place& place = places_[input.index];
  return place.input != nullptr && place.input->debounce().level();
}

void GpioLines::set_active(Line output, bool active) {
  const Place& place = places_[output.index];
  if (place.line != nullptr) place.line->set_active(active);
}

void GpioLines::advance(Instant now) {
  if (retry_at_ <= now) {
    retry_at_ = now + retry_interval;
    for (Place& place : places_) {
      if (place.line == nullptr) try_to_open(place);
    }
  }
  const bool reads_all = reread_at_ <= now;
  if (reads_all) reread_at_ = now + reread_interval;
  for (const Place& place : places_) {
    Input* const input = place.input.get();
    if (input == nullptr) continue;
    if (reads_all || input->has_moved() || input->debounce().settles_at() <= now) input->read(now);
  }
}

Instant GpioLines::next_deadline() const {
  Instant deadline = has_input() ? reread_at_ : never;
  if (is_any_missing()) deadline = std::min(deadline, retry_at_);
  for (const Place& place : places_) {
    if (place.input != nullptr) deadline = std::min(deadline, place.input->debounce().settles_at());
  }
  return deadline;
}

}  // namespace etcm::port
