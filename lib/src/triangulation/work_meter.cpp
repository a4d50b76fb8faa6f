#include "triangulation/work_meter.h"

namespace etcm::internal {

void WorkMeter::start(Work limit, const KeepAlive& keep_alive) noexcept {
  *this = WorkMeter{};
  limit_ = units_of(limit);
  taken_ = kept_ = slack;
  if (keep_alive.call == nullptr) return;
  keep_alive_ = &keep_alive;
  next_beat_ = taken_ + KeepAlive::units_between;
}

void WorkMeter::start_anew(Work limit, const KeepAlive& keep_alive) noexcept {
  start(limit, keep_alive);
  keeps_ = false;
}

void WorkMeter::go_back() noexcept {
  limit_ = units_of(Work::unlimited());
  is_going_back_ = true;
  is_over_ = false;
}

// Not inline: without a hook it is as good as never called.
[[gnu::noinline, gnu::cold]] void WorkMeter::beat() noexcept {
  if (keep_alive_ == nullptr) {
    next_beat_ = ~Units{0};
    return;
  }
  next_beat_ = taken_ + KeepAlive::units_between;
  call_out([this]() noexcept { keep_alive_->call(keep_alive_->context); });
}

[[gnu::noinline]] bool WalkBound::goes_on() noexcept {
  if (pause_ == most_) return false;
  meter_->pass(units_between);
  pause_ = most_ - pause_ > steps_between ? pause_ + steps_between : most_;
  return true;
}

}  // namespace etcm::internal
