#include "gpio/gpio_lines.h"

#include <algorithm>
#include <utility>

namespace etcm::port {

class GpioLines::Input final : private EventHandler {
 public:
  Input(EventLoop& loop, GpioLine& line, Duration period)
      : loop_(loop), line_(line), debounce_(line.is_active(), period) {
    loop_.add(line_.descriptor(), *this, true, false);
  }
  ~Input() { loop_.remove(line_.descriptor()); }
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;

  void read(Instant now) {
    debounce_.sample(line_.is_active(), std::exchange(has_moved_, false), now);
  }
  const Debounce& debounce() const { return debounce_; }
  bool has_moved() const { return has_moved_; }

 private:
  void on_ready(bool, bool) override {
    line_.discard_events();
    has_moved_ = true;
  }

  EventLoop& loop_;
  GpioLine& line_;
  Debounce debounce_;
  bool has_moved_ = false;
};

GpioLines::GpioLines(EventLoop& loop, std::span<const LineRequest> requests, Duration debounce)
    : loop_(loop) {
  for (const LineRequest& request : requests) {
    lines_.push_back(std::make_unique<GpioLine>(request));
    inputs_.push_back(request.use == LineUse::input
                          ? std::make_unique<Input>(loop_, *lines_.back(), debounce)
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
