// A position node in simulated time: what it knows, since when, and what it says when it is asked.
//
// Written from the register map and the Modbus specification, not with what the gateway reads with:
// what both got wrong would not show.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "etcm/port/clock.h"
#include "etcm/types.h"
#include "inputs/random.h"

namespace etcm::simulation {

using port::Duration;
using port::Instant;

// Each for itself, until the world ends it.
enum class Ailment : std::uint8_t {
  none,
  dead,      // says nothing
  slow,      // answers within its time, as late as it may
  late,      // answers seconds after its time, always as late
  erratic,   // answers at any time, or never
  noisy,     // half of its answers are spoilt on the way
  cut_off,   // half of its answers end too early
  busy,      // answers with an exception
  torn,      // changes its registers while they are read
  lost,      // has no fix
  forgetful  // starts again every few seconds, as long without an answer
};
inline constexpr std::size_t ailment_count = 11;

inline constexpr std::uint8_t read_holding = 3, read_input = 4;
// That it has, from the first.
inline constexpr std::uint16_t position_registers = 12;

// Where a node answers that has no unit of its own.
inline constexpr std::uint8_t newcomers_unit = 247;

// What its registers are.
enum class Make : std::uint8_t {
  ours,
  // Two blocks of input registers, which the gateway knows by a profile.
  in_blocks,
  checked  // so too, and its profile tells how fast it moves at the most
};
// Where the second block begins; whoever reads there has read the first one.
inline constexpr std::uint16_t second_block = 20;
// Whether this request, without its frame, reads what a gateway asks for first.
bool begins_a_sweep(std::span<const std::uint8_t> pdu);
// The profile of a make other than ours, for a site that counts in units of the mesh, and its name.
std::string profile_of(Make make);
const char* profile_name(Make make);

class Device {
 public:
  Device(std::uint32_t serial, std::size_t bus, std::uint8_t unit, Make make, Position place,
         Instant now);

  void move(Position place, Instant now);
  // It forgets what it was told, and its counter says that it has booted.
  void boot(Instant now);
  void fall_ill(Ailment ailment, Instant now, inputs::Random& random);
  // Anything that may keep it from being heard has ended, or begun.
  void disturb(Instant now) {
    undisturbed_since = std::max(undisturbed_since, now);
    answers = 0;
  }
  void note_answer(Instant now) {
    answered_at = now;
    if (undisturbed_since <= now) ++answers;
    spoilt = 0;
  }

  // Whether it stood there at any moment from `from` on.
  bool held(Position place, Instant from) const;
  // The same of each coordinate for itself.
  bool held_apart(Position place, Instant from) const;
  Position place() const { return places_.back().position; }

  // What it says to a whole request without its frame, and when it begins to; nothing where it
  // does not. `timeout`: it is waited for so long.
  struct Answer {
    std::vector<std::uint8_t> pdu;
    Duration after{};
    bool is_sound = true;  // it tells a position, in time, and nothing spoils it
  };
  std::optional<Answer> hear(std::span<const std::uint8_t> pdu, Instant now, Duration timeout,
                             inputs::Random& random);

  std::uint32_t serial;
  std::size_t bus;  // its number
  std::uint8_t unit;
  Make make;
  Ailment ailment = Ailment::none;
  Instant undisturbed_since;
  Instant silent_until{};     // nobody has plugged it in before
  Instant answered_at{};      // soundly and in time
  std::uint32_t answers = 0;  // such, since it was disturbed
  int spoilt = 0;             // questions and answers since, by others who talked meanwhile
  // When that was asked which it has said last; never, unless another one had answered it by then.
  Instant second_to = port::never;
  bool is_plugged_in = true;
  bool is_replaced = false;  // for good
  bool is_leaving = false;
  bool had_twin = false;    // another one answered at its unit
  bool keeps_unit = false;  // and takes no other one

  // Its neighbours, as it was told them last; none: not since it booted.
  struct Told {
    std::uint32_t generation = 0;
    std::set<std::uint32_t> serials;
    bool is_news = true;
  };
  std::optional<Told> told;

 private:
  struct Stay {
    Instant since;
    Position position;
  };

  void configure(std::span<const std::uint8_t> pdu);
  // To a write of several registers; empty: nothing.
  std::vector<std::uint8_t> take(std::span<const std::uint8_t> pdu);
  bool has_registers(std::uint8_t function, std::uint16_t first, std::uint16_t count) const;
  std::vector<std::uint16_t> our_registers(Instant now, inputs::Random& random) const;
  std::vector<std::uint16_t> blocks() const;
  template <class Test>
  bool has_stayed(Instant from, Test test) const;

  std::deque<Stay> places_;
  Duration lateness_{};
  std::uint16_t sequence_ = 1;
  std::uint16_t boots_ = 1;
  std::vector<std::uint16_t> configuration_;
};

}  // namespace etcm::simulation
