#include "triangulation/work_meter.h"

namespace etcm::internal {

void WorkMeter::start(Work limit) noexcept {
  *this = WorkMeter{};
  limit_ = units_of(limit);
  kept_ = slack;
}

void WorkMeter::start_anew(Work limit) noexcept {
  start(limit);
  keeps_ = 0;
}

void WorkMeter::go_back() noexcept {
  limit_ = units_of(Work::unlimited());
  is_going_back_ = true;
  is_over_ = false;
}

std::uint32_t WorkMeter::left() const noexcept {
  const Units taken = done_ + kept_;
  if (limit_ <= taken) return 0;
  return limit_ - taken < any_steps ? static_cast<std::uint32_t>(limit_ - taken) : any_steps - 1;
}

bool WorkMeter::fits(Units units) noexcept {
  const Units needed = done_ + kept_ + units;
  if (needed > peak_) peak_ = needed;
  const bool is_enough = has_room(units);
  if (!is_enough) is_over_ = true;
  return is_enough;
}

bool WorkMeter::spend(std::uint32_t units) noexcept {
  const bool is_whole = fits(units);
  done_ += is_whole ? units : left();
  return is_whole;
}

bool WorkMeter::spend(std::uint32_t units, std::uint32_t times_back) noexcept {
  const bool is_whole = spend(units);
  keep(Units{times_back} * units);
  return is_whole;
}

bool WorkMeter::spend_whole(Units units) noexcept {
  const bool is_whole = fits(units);
  if (is_whole) done_ += units;
  return is_whole;
}

void WorkMeter::add(Units units) noexcept { done_ += units; }

void WorkMeter::keep(Units units) noexcept { kept_ += units & keeps_; }

}  // namespace etcm::internal
