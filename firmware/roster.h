// Who is known: the nodes by serial, whichever unit they answer at.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "etcm/mesh.h"
#include "etcm/port/clock.h"
#include "node_map.h"
#include "poller.h"
#include "refusal.h"

namespace etcm::firmware {

struct NodeRecord {
  std::uint32_t serial = no_serial;  // no_serial: the record is free
  std::uint32_t unit = no_unit;      // where it answers; no_unit: it was there once, and is sought
  port::Instant known_since{};
  port::Instant heard_at{};
  port::Instant positioned_at{};
  Position position;         // last reported with a valid fix
  std::uint16_t status = 0;  // bits of node_status, last reported
  std::uint16_t boot_count = 0;
  bool stale = false;

  // In the mesh.
  VertexId vertex;  // none: not in the mesh
  Position placed;  // where the mesh has it

  // In quarantine; tried again when the node reports another place or the mesh made room.
  Refusal refusal;
  bool refused_to_leave = false;  // the mesh could not do without it
  Position refused_at;
  std::uint32_t refused_epoch = 0;
  port::Instant refused_since{};

  bool is_known() const { return serial != no_serial; }
  bool is_placed() const { return !vertex.is_none(); }
  bool is_quarantined() const { return !refusal.is_none(); }
};

// A node keeps its record when it changes its unit, its port or its bus. The memory is fixed: one
// record for each unit, and some for nodes whose unit another one has now.
class Roster {
 public:
  explicit Roster(std::uint32_t unit_count);

  // The node that answers at a unit, or null.
  NodeRecord* at(std::uint32_t unit);
  // When the node that was released last at this unit was heard; the origin: there was none.
  port::Instant released_heard_at(std::uint32_t unit) const { return released_heard_at_[unit]; }
  // All records, free ones between them.
  std::span<NodeRecord> records() { return records_; }
  std::span<const NodeRecord> records() const { return records_; }

  // The record of a serial, or null.
  NodeRecord* find(std::uint32_t serial);

  // A record for a serial that has none, at no unit; null when all are in use.
  NodeRecord* add(std::uint32_t serial, port::Instant now);
  // The node answers at this unit from now on. Whoever was known there is at none.
  void seat(NodeRecord& node, std::uint32_t unit);
  void release(NodeRecord& node);

 private:
  static constexpr std::uint32_t no_slot = 0xffffffff;
  struct Entry {
    std::uint32_t serial;
    std::uint32_t slot;
  };
  std::vector<Entry>::iterator lower_bound(std::uint32_t serial);

  std::vector<NodeRecord> records_;
  std::vector<std::uint32_t> free_;     // slots
  std::vector<Entry> by_serial_;        // sorted
  std::vector<std::uint32_t> by_unit_;  // slots
  std::vector<port::Instant> released_heard_at_;
};

}  // namespace etcm::firmware
