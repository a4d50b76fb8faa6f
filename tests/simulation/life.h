// A site and its gateway, which live through what is drawn from a seed. After each step what the
// gateway says is held against what is so; after the last fault it must find back to all of it.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "etcm/port/clock.h"

namespace etcm::simulation {

// What may happen to a site.
enum class Event : std::uint8_t {
  move,
  move_all,
  jump,
  fall_ill,
  get_well,
  unplug,
  plug_in,
  replace,
  twin,
  leave,
  dismiss,
  cut_bus,
  noise,
  hang_converter,
  mend_bus,
  disk_full,
  disk_hangs,
  mend_disk,
  power_loss,
  restart,
  stand_still,
  set_clock,
  read_page,
  change_settings,
  meet,
};
inline constexpr std::size_t event_count = 25;

struct Outcome {
  std::string wrong;  // and when; empty: nothing is
  port::Duration lived{};
  std::uint64_t steps = 0;
  std::uint64_t positions = 0;            // that were accepted
  std::uint64_t positions_of_others = 0;  // of these, of another make
  std::uint64_t generations = 0;
  std::uint64_t rebuilt = 0;   // meshes that were compared with build()
  std::uint64_t given = 0;     // units, to nodes that had none
  std::uint64_t births = 0;    // for Sparkplug
  std::uint64_t lists = 0;     // of neighbours, told to nodes
  std::uint64_t requests = 0;  // of other programs, that units have answered
  std::array<std::uint64_t, event_count> events{};
};

// Who is there besides the site and its gateway: nobody, or all of Others, also with devices of
// other makes, or with nodes that have no unit yet and a host of Sparkplug.
enum class Company : std::uint8_t { nobody, others, others_and_makes, others_and_newcomers };

// Faults for so long, then rest and the last judgement.
Outcome live(std::uint64_t seed, port::Duration faults, Company company);

}  // namespace etcm::simulation
