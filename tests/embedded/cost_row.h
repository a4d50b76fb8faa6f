// What is measured of one public call, and the line of it for cost.py.
#pragma once

#include <array>
#include <cstdint>

namespace etcm::test {

enum class Kind : std::uint8_t {
  change,    // its work is counted
  read,      // calls the hook
  question,  // calls no hook
};

// One call.
struct Measured {
  std::uint64_t instructions;
  std::uint64_t longest;  // between two calls of the hook
  std::uint64_t units;    // that a change needed
  std::uint32_t seed;     // of the input
  bool is_sample;         // of what a site is like
};

struct Row {
  const char* name;
  Kind kind = Kind::change;
  std::uint32_t count = 0;
  std::array<std::uint32_t, 96> samples{};
  std::uint64_t worst = 0;  // of samples
  std::uint64_t found = 0;  // of all
  std::uint32_t found_with = 0;
  std::uint64_t unit = 0;  // most instructions a unit, of calls of some size
  std::uint32_t unit_with = 0;
  std::uint64_t least = 0;  // most instructions of smaller ones
  std::uint64_t longest = 0;
  std::uint32_t longest_with = 0;

  void take(const Measured& call) noexcept;
  void take_worst_of(const Row& other) noexcept;
};

// Writes the line; returns whether units and hook kept to what lib/docs/work.md states.
bool put_row(Row& row) noexcept;

}  // namespace etcm::test
