// Gives nodes that answer at the default unit a unit of their own.
//
// First the new unit is asked, more than once where the answer is spoilt: others who wait at the
// default unit talk into it. Where it does not answer twice, and its bus has answered what was
// asked between the two, the node is written its new unit together with its serial, so that only
// the node with that serial takes it, however many wait at the default unit; then it must answer at
// the new unit. One node of a bus at a time.
//
// A unit that answered before is given last, and of these the one that has been silent
// longest first: its node may come back, and two nodes at one unit can be told nothing.
#pragma once

#include <cstdint>
#include <vector>

#include "etcm/port/log.h"
#include "firmware/config/settings.h"
#include "firmware/polling/bus_request.h"
#include "firmware/polling/poller.h"
#include "firmware/protocol/node_registers.h"
#include "firmware/records/node_table.h"

namespace etcm::firmware {

class AddressAssigner {
 public:
  // Who has answered at a unit that nobody was known to be at; none: nobody.
  struct Answerer {
    UnitIndex unit;
    bool is_assigned = false;  // the node that has been given it
  };

  // All arguments but `settings` must outlive this.
  AddressAssigner(const PollSettings& settings, const Poller& poller, NodeTable& nodes,
                  port::Log& log);

  // The poller may have more buses than before.
  void update_settings(const PollSettings& settings) {
    settings_ = settings;
    jobs_.resize(poller_.bus_count());
  }

  // This node answered at the default unit.
  void on_newcomer(BusIndex bus, Serial serial, port::Instant now);

  // As a RequestSource has them.
  port::Instant due(BusIndex bus) const;
  void next(BusIndex bus, BusRequest& request);
  Answerer done(BusIndex bus, const port::BusAnswer& answer, port::Instant now);
  // The node of the last done().
  Serial last_serial(BusIndex bus) const { return jobs_[bus.value].last_serial; }

 private:
  enum class Step : std::uint8_t { none, look, write, verify };
  struct Job {
    Step step = Step::none;
    port::Instant due = port::never;
    Serial serial;
    UnitIndex unit_index;          // the new one
    port::Instant unit_used_at{};  // as it was when the unit was chosen
    std::uint8_t tries = 0;        // of the step, in vain
    std::uint8_t silences = 0;     // looks that nobody answered
    port::Instant looked_at{};     // the end of the last look
    Serial last_serial;
    port::Instant retry_at{};  // with the same node as last time
    bool is_full = false;      // and said so
    Serial unwilling;          // did not take a unit, and the log says so
    AssignmentRegisters registers{};
  };

  bool is_free(UnitIndex unit) const;
  // When a node was last known to be there; the origin: never.
  port::Instant used_at(UnitIndex unit) const;
  // Takes the best of the free units that the bus may give, or the next best after the one chosen
  // before.
  void choose(BusIndex bus, bool is_first, port::Instant now);
  void give_up(Job& job, std::string_view why, port::Instant now);
  void end(Job& job, port::Instant retry_at);

  PollSettings settings_;
  const Poller& poller_;
  NodeTable& nodes_;
  port::Log& log_;
  std::vector<Job> jobs_;  // by bus
};

}  // namespace etcm::firmware
