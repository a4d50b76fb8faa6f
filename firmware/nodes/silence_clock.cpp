#include "firmware/nodes/silence_clock.h"

#include <utility>

namespace etcm::firmware {

namespace {

// Where one node alone answers, its answers are an interval apart, and one may be late.
constexpr std::int64_t answer_gap_max = 2;  // intervals
// And one may be lost.
constexpr std::int64_t sound_gap_max = 3;  // intervals

}  // namespace

SilenceClock::SilenceClock(const PollSettings& settings, std::uint32_t bus_count)
    : settings_(settings), buses_(bus_count) {}

void SilenceClock::turn(port::Instant now, port::Duration turn_max) {
  const port::Instant before = std::exchange(turned_at_, now);
  if (!std::exchange(has_turned_, true)) return;
  const port::Duration passed = std::clamp(now - before, port::Duration{}, turn_max);
  listened_ += passed;
  of_none_.shown += passed;
}

bool SilenceClock::hear(BusIndex bus, port::Instant now) {
  const bool was_silent = heard_at(bus) == port::Instant{} || is_silent(bus);
  BusClock& clock = buses_[bus.value];
  clock.shown += std::min(listened_ - clock.heard, answer_gap_max * settings_.interval);
  if (was_silent) clock.counts_from = std::max(clock.counts_from, clock.shown);
  clock.heard = listened_;
  clock.heard_at = now;
  return was_silent;
}

port::Duration SilenceClock::silence_since(BusIndex bus, port::Duration heard) const {
  const BusClock& clock = clock_of(bus);
  return clock.shown - std::max(heard, clock.counts_from);
}

bool SilenceClock::is_silent(BusIndex bus) const {
  return silence_of(bus) > std::max(settings_.stale_after, sound_gap_max * settings_.interval);
}

void SilenceClock::postpone(port::Duration time) {
  postponed_to_ = listened_ + time;
  of_none_.counts_from = of_none_.shown + time;
  for (BusClock& clock : buses_) clock.counts_from = clock.shown + time;
}

}  // namespace etcm::firmware
