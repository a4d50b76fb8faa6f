// Which nodes are there: with a fresh position, silent, or missing.
//
// A node whose own silence (silence_clock.h) is longer than leave_after leaves the mesh and is
// missing: it stays known, with its last place and unit, until it answers again, asks to leave, or
// is dismissed. One that asked to leave before it fell silent is not missing.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "etcm/port/log.h"
#include "firmware/config/settings.h"
#include "firmware/mesh/node_placement.h"
#include "firmware/nodes/silence_clock.h"
#include "firmware/polling/poller.h"
#include "firmware/protocol/node_registers.h"
#include "firmware/records/node_table.h"
#include "firmware/records/reading_table.h"

namespace etcm::firmware {

class Presence {
 public:
  // All arguments but `settings` must outlive this.
  Presence(const PollSettings& settings, const Poller& poller, NodeTable& nodes,
           ReadingTable& readings, NodePlacement& placement, port::Log& log);

  // The gateway's loop turns: before anything is heard in this turn.
  void turn(port::Instant now);

  // A sound answer of this unit, whichever node it is from.
  void hear_unit(UnitIndex unit, port::Instant now);
  // It is this node's. After hear_unit().
  void hear_node(NodeRecord& node, const NodeReading& reading, port::Instant now);
  // It is of a node that another gateway has: should that lose it, it has not been silent here.
  void hear_foreign(NodeRecord& node) const { node.heard = clock_.shown(bus_of(node)); }

  // Finds nodes whose position is no longer fresh, those to leave, readings that are no longer
  // fresh, and silent buses.
  // `generation` is what the log calls the result.
  void sweep(port::Instant now, std::uint32_t generation);
  bool is_due(port::Instant now) const { return sweep_due_ <= now; }
  port::Instant next_deadline() const { return sweep_due_; }

  // No node needs to have answered before `heard_by`.
  void update_settings(const PollSettings& settings, port::Instant heard_by, port::Instant now);
  // It is waited for no longer. False: it is not missing, or the mesh cannot do without it.
  bool dismiss(NodeRecord& node);
  // Those known from an earlier run: the log says how many, and one of them.
  void tell_missing(port::Instant now);

  // No node of the bus answers, though some are known to be on it; or none of its `units` has
  // answered since the start, and leave_after has passed.
  bool is_silent(BusIndex bus) const { return buses_[bus.value].is_silent; }
  std::uint32_t silent_bus_count() const;
  // Nodes that answered at the last sweep and had not told where they are.
  std::uint32_t waiting_count() const { return waiting_; }
  const SilenceClock& clock() const { return clock_; }

  // Whether anything that is published changed since the last call.
  bool take_changed() { return std::exchange(changed_, false); }

 private:
  struct Bus {
    std::uint32_t nodes = 0;  // that are known to be on it
    bool is_silent = false;
  };

  BusIndex bus_of(const NodeRecord& node) const;
  // What was heard then is no longer fresh.
  bool is_old(port::Instant heard_at, port::Instant now) const {
    return now - std::max(heard_at, fresh_from_) > settings_.stale_after;
  }
  void check_node(NodeRecord& node, port::Instant now, std::uint32_t generation);
  void lose(NodeRecord& node, port::Instant now, std::uint32_t generation);
  void note_leaving(NodeRecord& node, port::Instant now);
  void check_freshness(NodeRecord& node, port::Instant now);
  void tell_no_fix(const NodeRecord& node, port::Instant now);
  void tell_fix(const NodeRecord& node, port::Instant now);
  void check_readings(port::Instant now);
  void check_bus(BusIndex bus, port::Instant now);
  bool has_never_answered(BusIndex bus) const;
  void tell_silent(BusIndex bus, port::Instant now);

  PollSettings settings_;
  const Poller& poller_;
  NodeTable& nodes_;
  ReadingTable& readings_;
  NodePlacement& placement_;
  port::Log& log_;
  SilenceClock clock_;
  std::vector<Bus> buses_;
  std::uint32_t waiting_ = 0;
  port::Duration sweep_interval_;
  port::Instant sweep_due_{};
  port::Instant fresh_from_{};  // no position and no reading counts as older
  bool changed_ = false;
};

// The unit where a missing node answered last, for a person: "unit 7 of yard".
TextLine last_place_of(const NodeRecord& node, const Poller& poller);

}  // namespace etcm::firmware
