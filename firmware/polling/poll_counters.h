// What happened on the buses, in numbers that only grow.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "etcm/port/clock.h"
#include "etcm/port/node_bus.h"
#include "firmware/logging/text_line.h"
#include "firmware/profile/profile.h"
#include "firmware/protocol/node_registers.h"

namespace etcm::firmware {

// What was wrong with a question.
enum class UnitFault : std::uint8_t {
  none,
  timeout,
  exception,
  bad_answer,
  link_lost,
  torn,
  unbelieved,
  jumped,
};

// The unit was heard, and what it said was of no use.
constexpr bool is_of_an_answer(UnitFault fault) {
  switch (fault) {
    case UnitFault::exception:
    case UnitFault::bad_answer:
    case UnitFault::torn:
    case UnitFault::unbelieved:
    case UnitFault::jumped:
      return true;
    case UnitFault::none:
    case UnitFault::timeout:
    case UnitFault::link_lost:
      break;
  }
  return false;
}

constexpr UnitFault fault_of(port::BusResult result) {
  switch (result) {
    case port::BusResult::ok:
      break;
    case port::BusResult::timeout:
      return UnitFault::timeout;
    case port::BusResult::exception:
      return UnitFault::exception;
    case port::BusResult::bad_answer:
      return UnitFault::bad_answer;
    case port::BusResult::link_lost:
      return UnitFault::link_lost;
  }
  return UnitFault::none;
}

// How the last questions to a unit went, 64 at the most.
class RecentQuestions {
 public:
  void add(bool is_sound) {
    faults_ = faults_ << 1 | (is_sound ? 0u : 1u);
    count_ = std::min(count_ + 1, 64u);
  }
  // The newest was not sound after all.
  void spoil() { faults_ |= 1u; }
  std::uint32_t count() const { return count_; }
  std::uint32_t faults() const { return static_cast<std::uint32_t>(std::popcount(faults_)); }

 private:
  std::uint64_t faults_ = 0;  // a bit each, the newest lowest
  std::uint32_t count_ = 0;
};

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
  port::Instant sound_since{};  // no question has failed from then on; the origin: never
  port::Instant sound_at{};     // the last sound answer; the origin: never
  RecentQuestions recent{};
  UnitFault last_fault = UnitFault::none;
  std::uint8_t exception = 0;                        // the last one
  ReadingFault unbelieved_for = ReadingFault::none;  // of the last one; none: the wrong node
  // Why the last answer of a device had no position, where it had none.
  DevicePosition::State told = DevicePosition::State::value;
  port::Instant failed_at{};                // last
  UnitFault heard_fault = UnitFault::none;  // the last one that was an answer
  port::Instant heard_fault_at{};

  void note_fault(UnitFault fault, port::Instant now) {
    last_fault = fault;
    failed_at = now;
    recent.spoil();
    if (!is_of_an_answer(fault)) return;
    heard_fault = fault;
    heard_fault_at = now;
  }
  std::uint64_t count(port::BusResult result) const {
    return results[static_cast<std::size_t>(result)];
  }
  // A unit that answers with an exception is there too.
  bool has_answered() const {
    return count(port::BusResult::ok) + count(port::BusResult::exception) > 0;
  }
};

// What was wrong with the last answer of a unit that was not believed, and what to do about it.
TextLine explain_unbelieved(const UnitCounters& counters);

struct BusCounters {
  port::Instant up_since{};         // the link is there; the origin: it is not
  port::Instant answered_at{};      // last, by any of its units; the origin: never
  port::Instant heard_at{};         // anything else came last, sound or not
  port::Instant heard_asked_at{};   // that was asked then which came so, the last of it
  port::Instant absence_told_at{};  // a converter said last that nobody is there
  port::Duration busy{};            // while at least one question was under way
  port::Duration floor{};  // least time the bytes and silences of the answered ones need on a line
};

}  // namespace etcm::firmware
