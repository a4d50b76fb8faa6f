// Which silence says something about a node.
//
// What lies between a node and the gateway (a cable, a converter, a connection), or the gateway
// itself where it did not run, silences all nodes of a bus at once, and that says nothing of any of
// them. So each bus has a clock of its own that runs while its nodes answer: it goes on with each
// answer, by no more than the pause that units of a sound bus make. The silence of a node is what
// this clock has counted since its last answer.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "etcm/port/clock.h"
#include "firmware/config/settings.h"
#include "firmware/polling/indices.h"

namespace etcm::firmware {

class SilenceClock {
 public:
  SilenceClock(const PollSettings& settings, std::uint32_t bus_count);

  void update_settings(const PollSettings& settings) { settings_ = settings; }
  // There are so many buses now; the silence of a new one counts from here.
  void add_buses(std::uint32_t bus_count) {
    buses_.resize(bus_count, {.shown = {}, .counts_from = {}, .heard = listened_});
  }

  // The gateway's loop turns, by itself at the latest `turn_max` after the turn before. What was
  // longer (a program that was stopped, a clock that jumped) is as if it had not been.
  void turn(port::Instant now, port::Duration turn_max);

  // A node of the bus answers. True where the bus was silent until now: each of its nodes then has
  // its whole time anew.
  bool hear(BusIndex bus, port::Instant now);

  // No unit of this bus can have answered by now.
  void excuse(BusIndex bus) { buses_[bus.value].heard = listened_; }

  // What the clock of a bus shows. That of none, of a node that is known from an earlier run and
  // whose bus there is no more, runs while the gateway listens.
  port::Duration shown(BusIndex bus) const { return clock_of(bus).shown; }
  // The silence of a node of this bus that answered when the clock showed `heard`.
  port::Duration silence_since(BusIndex bus, port::Duration heard) const;

  // Whether a bus is silent as a whole: none of its nodes has answered for longer than a sound one
  // takes.
  bool is_silent(BusIndex bus) const;
  // For how long none has, as far as that counts.
  port::Duration silence_of(BusIndex bus) const {
    return std::max(listened_ - std::max(buses_[bus.value].heard, postponed_to_), port::Duration{});
  }
  // When one did last; the origin: never.
  port::Instant heard_at(BusIndex bus) const { return buses_[bus.value].heard_at; }

  // No answer is due before so much has passed: until then no silence counts.
  void postpone(port::Duration time);

 private:
  struct BusClock {
    port::Duration shown{};
    port::Duration counts_from{};  // what it showed when the bus was silent last
    port::Duration heard{};        // of the time that the gateway has listened
    port::Instant heard_at{};
  };
  const BusClock& clock_of(BusIndex bus) const {
    return bus.is_none() ? of_none_ : buses_[bus.value];
  }

  PollSettings settings_;
  std::vector<BusClock> buses_;
  BusClock of_none_;
  port::Duration listened_{};
  port::Duration postponed_to_{};  // of the time that the gateway has listened
  port::Instant turned_at_{};
  bool has_turned_ = false;
};

}  // namespace etcm::firmware
