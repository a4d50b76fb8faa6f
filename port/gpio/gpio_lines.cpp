#include "gpio/gpio_lines.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
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

GpioLines::GpioLines(EventLoop& loop, Log& log, std::span<const LineRequest> requests,
                     Duration debounce) {
  for (const LineRequest& request : requests) {
    lines_.push_back(std::make_unique<GpioLine>(request));
    inputs_.push_back(
        request.use == LineUse::input
            ? std::make_unique<Input>(loop, log, *lines_.back(), request.place, debounce)
            : nullptr);
    has_input_ = has_input_ || request.use == LineUse::input;
  }
}

GpioLines::~GpioLines() = default;

bool GpioLines::is_active(Line input) const { return inputs_[input.index]->debounce().level(); }

void GpioLines::set_active(Line output, bool active) { lines_[output.index]->set_active(active); }

void GpioLines::advance(Instant now) {
  const bool reads_all = reread_at_ <= now;
  if (reads_all) reread_at_ = now + reread_interval;
  for (const auto& input : inputs_) {
    if (input == nullptr) continue;
    if (reads_all || input->has_moved() || input->debounce().settles_at() <= now) input->read(now);
  }
}

Instant GpioLines::next_deadline() const {
  Instant deadline = has_input_ ? reread_at_ : never;
  for (const auto& input : inputs_) {
    if (input != nullptr) deadline = std::min(deadline, input->debounce().settles_at());
  }
  return deadline;
}

}  // namespace etcm::port
