// A unit as an operator is told of it.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "firmware/gateway/gateway.h"
#include "firmware/polling/indices.h"
#include "firmware/polling/poll_counters.h"
#include "firmware/status/status_sources.h"

namespace etcm::firmware {

enum class UnitState : std::uint8_t {
  answering,
  faulty,  // it answers, but its last answer is of no use
  silent,
};

struct ShownUnit {
  std::string_view bus;  // as much of its name as there is room for
  std::uint8_t address = 0;
  UnitState state = UnitState::silent;
  // For so long it has answered, or has not had a sound answer; none: it had none in this run, and
  // when it had one before is not known.
  std::optional<port::Duration> since;
  // Its node is known from before the start of this run, in which it has not answered.
  bool has_answered_before = false;
  std::string_view profile;  // as much of its name as there is room for; empty: a node of our own
  // The node that answers there, or did until it was missing, and what it said last; null: none.
  const NodeRecord* node = nullptr;
  std::string_view name;  // of that node, or of the unit; empty: nobody has named it
  bool is_moving = false;
  bool has_low_battery = false;
  bool has_left = false;  // it has said so
  bool lacks_fix = false;
};

// A unit that is named in the settings, or has ever answered: units that are only looked for would
// be most of what is shown.
bool is_shown(const Poller& poller, UnitIndex unit);

// It does, as far as is known.
bool is_answering(const Gateway& gateway, UnitIndex unit);

// O(nodes) for a unit where no node answers.
ShownUnit shown_unit(const StatusSources& sources, UnitIndex unit, port::Instant asked_at);

// For how long a node has been missing, and a bus silent. As its alarm has it, where one is on: one
// from before a restart has the time of day, which is right as soon as the clock is.
port::Duration missing_for(const StatusSources& sources, const NodeRecord& node,
                           port::Instant asked_at);
port::Duration silent_for(const StatusSources& sources, BusIndex bus, port::Instant asked_at);

const char* to_string(UnitState state);
const char* to_string(UnitFault fault);  // "" for none

}  // namespace etcm::firmware
