#include "triangulation/work_meter.h"

namespace etcm::internal {

void WorkMeter::start(Work limit) noexcept {
  *this = WorkMeter{};
  limit_ = limit.units;
  kept_ = slack;
}

void WorkMeter::start_anew(Work limit) noexcept {
  start(limit);
  keeps_ = 0;
}

void WorkMeter::go_back() noexcept {
  limit_ = Work::unlimited().units;
  is_going_back_ = true;
  is_over_ = false;
}

std::uint32_t WorkMeter::left() const noexcept {
  const std::uint64_t taken = done_ + kept_;
  if (limit_ <= taken) return 0;
  return limit_ - taken < any_steps ? static_cast<std::uint32_t>(limit_ - taken) : any_steps - 1;
}

bool WorkMeter::fits(std::uint64_t units) noexcept {
  const std::uint64_t needed = done_ + kept_ + units;
  if (needed > peak_) peak_ = needed;
  if (needed > limit_) is_over_ = true;
  return needed <= limit_;
}

bool WorkMeter::spend(std::uint32_t units) noexcept {
  const bool is_whole = fits(units);
  done_ += is_whole ? units : left();
  return is_whole;
}

bool WorkMeter::spend(std::uint32_t units, std::uint32_t times_back) noexcept {
  const bool is_whole = spend(units);
  keep(std::uint64_t{times_back} * units);
  return is_whole;
}

bool WorkMeter::spend_whole(std::uint64_t units) noexcept {
  const bool is_whole = fits(units);
  if (is_whole) done_ += units;
  return is_whole;
}

void WorkMeter::add(std::uint64_t units) noexcept { done_ += units; }

void WorkMeter::keep(std::uint64_t units) noexcept { kept_ += units & keeps_; }

}  // namespace etcm::internal
