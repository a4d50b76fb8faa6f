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
  Input(EventLoop& loop, GpioLine& line, Duration period)
      : loop_(loop), line_(line), debounce_(line.is_active().value_or(false), period) {
    loop_.add(line_.descriptor(), *this, true, false);
  }
  ~Input() {
    if (why_gone_ == 0) loop_.remove(line_.descriptor());
  }
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;

  void read(Instant now) {
    if (why_gone_ != 0) return;
    // Not each kernel tells otherwise that the chip has gone.
    const std::optional<bool> level = line_.is_active();
    if (!level) return stop(errno);
    debounce_.sample(*level, std::exchange(has_moved_, false), now);
  }
  const Debounce& debounce() const { return debounce_; }
  bool has_moved() const { return has_moved_; }
  // 0: it is not.
  int why_gone() const { return why_gone_; }

 private:
  void on_ready(bool, bool) override {
    has_moved_ = true;
    // Waiting for one that has gone is impossible: it is ready all the time.
    if (!line_.discard_events()) stop(errno);
  }
  void stop(int error) {
    why_gone_ = error;
    loop_.remove(line_.descriptor());
  }

  EventLoop& loop_;
  GpioLine& line_;
  int why_gone_ = 0;
  Debounce debounce_;
  bool has_moved_ = false;
};

GpioLines::RequestedLine::RequestedLine(LineRequest wanted) : request(std::move(wanted)) {}
GpioLines::RequestedLine::RequestedLine(RequestedLine&&) noexcept = default;
GpioLines::RequestedLine::~RequestedLine() = default;

GpioLines::GpioLines(EventLoop& loop, Log& log, std::span<const LineRequest> requests,
                     Duration debounce)
    : loop_(loop), log_(log), debounce_(debounce) {
  for (const LineRequest& request : requests) try_to_open(requested_.emplace_back(request));
}

GpioLines::~GpioLines() = default;

void GpioLines::try_to_open(RequestedLine& requested) {
  try {
    requested.gpio_line = std::make_unique<GpioLine>(requested.request);
  } catch (const std::runtime_error& error) {
    if (std::exchange(requested.is_told, true)) return;
    log_.write(Level::error, std::string(error.what()) + "; goes on without it, and tries again");
    return;
  }
  if (requested.request.use == LineUse::input) {
    requested.input = std::make_unique<Input>(loop_, *requested.gpio_line, debounce_);
  }
  if (std::exchange(requested.is_told, false))
    log_.write(Level::info, "gpio line " + requested.request.name + " is there");
}

void GpioLines::drop(RequestedLine& requested, int error) {
  requested.input.reset();
  requested.gpio_line.reset();
  requested.is_told = true;
  log_.write(Level::error, "gpio line " + requested.request.name + " is gone (" +
                               std::strerror(error) +
                               "); goes on without it, and tries again; plug its chip in again");
}

bool GpioLines::is_any_missing() const {
  return std::any_of(requested_.begin(), requested_.end(),
                     [](const RequestedLine& requested) { return requested.gpio_line == nullptr; });
}

bool GpioLines::has_input() const {
  return std::any_of(requested_.begin(), requested_.end(),
                     [](const RequestedLine& requested) { return requested.input != nullptr; });
}

bool GpioLines::is_active(DigitalLine input) const {
  const RequestedLine& requested = requested_[input.index];
  return requested.input != nullptr && requested.input->debounce().level();
}

void GpioLines::set_active(DigitalLine output, bool active) {
  RequestedLine& requested = requested_[output.index];
  if (requested.gpio_line == nullptr || requested.gpio_line->set_active(active)) return;
  drop(requested, errno);
}

void GpioLines::advance(Instant now) {
  if (retry_at_ <= now) {
    retry_at_ = now + retry_interval;
    for (RequestedLine& requested : requested_) {
      if (requested.gpio_line == nullptr) try_to_open(requested);
    }
  }
  const bool reads_all = reread_at_ <= now;
  if (reads_all) reread_at_ = now + reread_interval;
  for (RequestedLine& requested : requested_) {
    Input* const input = requested.input.get();
    if (input == nullptr) continue;
    if (reads_all || input->has_moved() || input->debounce().settles_at() <= now) input->read(now);
    if (input->why_gone() != 0) drop(requested, input->why_gone());
  }
}

Instant GpioLines::next_deadline() const {
  Instant deadline = has_input() ? reread_at_ : never;
  if (is_any_missing()) deadline = std::min(deadline, retry_at_);
  for (const RequestedLine& requested : requested_) {
    if (requested.input != nullptr)
      deadline = std::min(deadline, requested.input->debounce().settles_at());
  }
  return deadline;
}

}  // namespace etcm::port
