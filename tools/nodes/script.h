// What the simulated nodes do and when: the CSV file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "etcm/types.h"

namespace etcm::nodes {

enum class Action : std::uint8_t {
  join,    // answers from now on, at x,y
  move,    // stands at x,y from now on
  silent,  // answers no more
  leave,   // answers, with the status bit that asks to be taken out
  unit,    // answers at unit `value` of its port from now on
  twin,    // another node with this serial answers from now on, at x,y
  jitter,  // stands up to `value` beside its place, elsewhere every 100 ms
  drift,   // moves by x,y a second from now on
  no_fix,  // answers, but does not know where it stands
  low_battery,
  boot,  // starts afresh: what was written to it is gone
  // From now on it answers, but
  exception,   // with exception `value`
  torn,        // with two sequence numbers that differ
  late,        // `value` milliseconds too late
  garbled,     // with a wrong bit
  truncated,   // with half of the bytes
  wrong_unit,  // as its neighbour
  noise,       // after other bytes
  // and from now on as it should.
  sound,
};

// Whether it is a way to answer wrongly; late, garbled, truncated, wrong_unit and noise can be
// heard on a serial line only.
constexpr bool is_fault(Action action) { return action >= Action::exception; }

struct Event {
  std::uint32_t time_ms = 0;
  // Counts the nodes in the order in which the file first names them; a twin is one of its own.
  std::uint32_t node = 0;
  Action action = Action::join;
  Position position;        // of join, move, twin and drift
  std::uint16_t value = 0;  // of exception, late, unit and jitter
};

struct Script {
  std::vector<std::uint32_t> serials;  // by node
  std::vector<Event> events;           // by time
};

// Reads the file; README.md has the columns. Throws std::runtime_error with one line
// "file:line: what is wrong; the cure".
Script read_script(const std::string& path);

}  // namespace etcm::nodes
