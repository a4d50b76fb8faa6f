// The known nodes by serial, whichever unit they answer at.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "etcm/mesh.h"
#include "etcm/port/clock.h"
#include "firmware/config/settings.h"
#include "firmware/polling/poller.h"
#include "firmware/protocol/node_registers.h"
#include "firmware/records/name_book.h"
#include "firmware/site/rejection.h"

namespace etcm::firmware {

// Another gateway of the fleet, by its place in the list of them.
using MemberIndex = StrongId<struct MemberTag>;

struct NodeRecord {
  Serial serial;         // none: the record is free
  MemberIndex owner;     // the gateway that hears it; none: this one
  UnitIndex unit_index;  // where it answers; none: it was there once, and is sought
  UnitIndex last_unit;   // where it answered last; none: on none there is now
  port::Instant known_since{};
  port::Instant heard_at{};     // by its owner
  port::Instant answered_at{};  // here, at its unit; the origin: not in this run
  port::Duration heard{};       // the same, as the clock of its bus showed it (silence_clock.h)
  port::Instant positioned_at{};
  port::Instant left_at{};   // it has said since then that it leaves; the origin: it does not
  Position position;         // last reported with a valid fix
  std::uint16_t status = 0;  // bits of node_status, last reported
  std::uint16_t boot_count = 0;
  bool stale = false;      // its position is no longer fresh
  bool lacks_fix = false;  // it is stale although it answers
  bool is_missing = false;

  // In the mesh.
  VertexId vertex;  // none: not in the mesh
  Position placed;  // where the mesh has it

  // In quarantine; tried again when the node reports another place or the mesh made room.
  Rejection rejection;
  bool leave_rejected = false;  // the mesh could not do without it
  Position rejected_at;
  std::uint32_t rejected_epoch = 0;
  port::Instant rejected_since{};

  bool is_known() const { return !serial.is_none(); }
  bool is_foreign() const { return !owner.is_none(); }
  bool is_placed() const { return !vertex.is_none(); }
  bool is_quarantined() const { return !rejection.is_none(); }
  bool has_position() const { return positioned_at != port::Instant{}; }
  bool has_asked_to_leave() const { return (status & node_status::leaving) != 0; }
  // It answers, and has not told yet where it is.
  bool is_waiting() const {
    return is_known() && !is_foreign() && !is_missing && !is_placed() && !is_quarantined() &&
           !has_asked_to_leave();
  }
};

// A node keeps its record when it changes its unit, its port or its bus, and while it is missing.
// One record for each unit, and some for nodes whose unit another one has now and for those that
// are missing. The memory for all units that there may ever be is taken at the start.
constexpr std::uint32_t node_record_capacity(std::uint32_t unit_count) {
  return unit_count + unit_count / 4 + 16;
}

class NodeTable {
 public:
  // `unit_room`: so many there may be in the end. `foreign_room`: for so many nodes of other
  // gateways there is room beside.
  NodeTable(std::uint32_t unit_count, std::uint32_t unit_room, std::uint32_t foreign_room = 0);

  // There are so many units now: not fewer than before, nor more than there is room for.
  void add_units(std::uint32_t unit_count);

  // The node that answers at a unit, or null.
  NodeRecord* at(UnitIndex unit);
  const NodeRecord* at(UnitIndex unit) const;
  // When the node that went from this unit last was heard; the origin: there was none.
  port::Instant released_heard_at(UnitIndex unit) const { return released_heard_at_[unit.value]; }
  // A node went from this unit, in an earlier run.
  void note_gone(UnitIndex unit, port::Instant heard_at) {
    released_heard_at_[unit.value] = heard_at;
  }
  // All records, free ones between them.
  std::span<NodeRecord> records() { return records_; }
  std::span<const NodeRecord> records() const { return records_; }

  // The record of a serial, or null.
  NodeRecord* find(Serial serial);
  const NodeRecord* find(Serial serial) const;

  // A record for a serial that has none, at no unit; null when all are in use.
  NodeRecord* add(Serial serial, port::Instant now);
  // The node answers at this unit from now on. The one that was there is at none.
  void assign_unit(NodeRecord& node, UnitIndex unit);
  // It answers at no unit any more; the one it had is free for others.
  void vacate(NodeRecord& node);
  void release(NodeRecord& node);

  // What nodes are called from now on. REQUIRES: not null.
  void set_names(std::shared_ptr<const NameBook> names) { names_ = std::move(names); }
  const std::shared_ptr<const NameBook>& names() const { return names_; }
  // By the unit where it answered last, too, unless another gateway hears it.
  NameIndex name_of(const NodeRecord& node) const;
  // For a line of the log; of any serial, known or not. O(log n).
  CalledNode called(const NodeRecord& node) const;
  CalledNode called(Serial serial) const;

 private:
  static constexpr std::uint32_t no_slot = 0xffffffff;
  struct Entry {
    Serial serial;
    std::uint32_t slot;
  };
  std::vector<Entry>::const_iterator lower_bound(Serial serial) const;

  const std::uint32_t foreign_room_;
  std::vector<NodeRecord> records_;
  std::vector<std::uint32_t> free_;     // slots
  std::vector<Entry> by_serial_;        // sorted
  std::vector<std::uint32_t> by_unit_;  // slots
  std::vector<port::Instant> released_heard_at_;
  std::shared_ptr<const NameBook> names_ = std::make_shared<const NameBook>();
};

}  // namespace etcm::firmware
