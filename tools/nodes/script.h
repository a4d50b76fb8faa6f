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
};

struct Event {
  std::uint32_t time_ms = 0;
  std::uint32_t node = 0;  // counts the serials in the order in which the file first names them
  Action action = Action::join;
  Position position;  // of join and move
};

struct Script {
  std::vector<std::uint32_t> serials;  // by node
  std::vector<Event> events;           // by time
};

// Reads the file; README.md has the columns. Throws std::runtime_error with one line
// "file:line: what is wrong; the cure".
Script read_script(const std::string& path);

}  // namespace etcm::nodes
