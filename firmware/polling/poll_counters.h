// What happened on the buses, in numbers that only grow.
#pragma once

#include <array>
#include <cstdint>

#include "etcm/port/clock.h"
#include "etcm/port/node_bus.h"

namespace etcm::firmware {

struct UnitCounters {
  std::uint64_t requests = 0;
  std::array<std::uint64_t, port::bus_result_count> results{};  // by BusResult
  // Of the results that are ok:
  std::uint64_t torn = 0;        // the node changed its registers meanwhile
  std::uint64_t unbelieved = 0;  // not the registers of a node, or not of the one expected
  std::uint64_t jumped = 0;      // a position too far from the one before it, and not twice
  port::Instant answered_at{};   // last, if only with an exception; the origin: never
  port::Duration answer_time{};  // from the question to the answer, of all together
  port::Duration answer_time_last{};
  port::Duration answer_time_max{};

  std::uint64_t count(port::BusResult result) const {
    return results[static_cast<std::size_t>(result)];
  }
  // A unit that answers with an exception is there too.
  bool has_answered() const {
    return count(port::BusResult::ok) + count(port::BusResult::exception) > 0;
  }
};

struct BusCounters {
  port::Instant answered_at{};      // last, by any of its units; the origin: never
  port::Instant heard_at{};         // anything else came last, sound or not
  port::Instant absence_told_at{};  // a converter said last that nobody is there
  port::Duration busy{};            // while at least one question was under way
  port::Duration floor{};  // least time the bytes and silences of the answered ones need on a line
};

}  // namespace etcm::firmware
