// Which node an answer is from: its serial says so, as far as that can be believed.
//
// A node may change its unit, its port or its bus and is still the same node. What cannot be is an
// alarm, said once, and never a back and forth: two nodes with one serial, two nodes at one unit, a
// serial with its words swapped.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "etcm/port/log.h"
#include "firmware/config/settings.h"
#include "firmware/nodes/identity_conflict.h"
#include "firmware/polling/poller.h"
#include "firmware/records/feature_table.h"
#include "firmware/records/node_table.h"

namespace etcm::firmware {

// What is conflicting at a unit.
struct UnitConflict {
  Serial serial;  // that is not believed
  IdentityConflict conflict = IdentityConflict::none;
  std::uint8_t sightings = 0;  // of it in a row
  port::Instant since{};
  port::Instant seen_at{};
  Serial displaced;         // the node that was at this unit before the present one
  bool alternates = false;  // both have answered here since, or that one is back already

  bool is_alarm() const { return conflict > IdentityConflict::waiting; }
};

class Admission {
 public:
  // All arguments but `settings` must outlive this.
  Admission(const PollSettings& settings, const FeatureTable& features, NodeTable& nodes,
            const Poller& poller, port::Log& log);

  // The poller may have more units than before.
  void update_settings(const PollSettings& settings) {
    settings_ = settings;
    conflicts_.resize(poller_.unit_count());
  }

  // The record of the node that answered; null when it is not believed, at least not yet.
  NodeRecord* admit(UnitIndex unit, Serial serial, port::Instant now);

  // Drops conflicts for which there has been no reason lately, and the units of nodes that answer
  // at other gateways by now.
  void sweep(port::Instant now);

  // By unit.
  std::span<const UnitConflict> conflicts() const { return conflicts_; }
  // Whether an alarm came or went since the last call.
  bool take_changed() { return std::exchange(changed_, false); }

 private:
  // Whether a feature ends at this serial.
  bool is_named(Serial serial) const { return !features_.ending_at(serial).empty(); }
  port::Instant answered_at(const NodeRecord& node) const;
  bool has_gone(const NodeRecord& node, port::Instant now) const;
  bool may_be_back(UnitConflict& conflict, const NodeRecord& here, port::Instant now) const;
  // A record for a node that is not known; null where there is no room for it.
  NodeRecord* add(Serial serial, port::Instant now);
  // Null, always; says why when that is news. `other`: the serial that is believed.
  NodeRecord* disbelieve(UnitIndex unit, IdentityConflict conflict, Serial other);
  void clear(UnitConflict& conflict);

  PollSettings settings_;
  const FeatureTable& features_;
  NodeTable& nodes_;
  const Poller& poller_;
  port::Log& log_;
  std::vector<UnitConflict> conflicts_;
  bool changed_ = false;
};

}  // namespace etcm::firmware
