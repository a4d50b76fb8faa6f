// Who is known: the nodes by serial, each at the unit that last answered for it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "etcm/mesh.h"
#include "etcm/port/clock.h"
#include "node_map.h"

namespace etcm::firmware {

struct NodeRecord {
  std::uint32_t serial = no_serial;  // no_serial: nobody is known at this unit
  Position position;                 // last reported with a valid fix
  port::Instant heard_at{};
  port::Instant positioned_at{};
  bool stale = false;

  // In the mesh.
  VertexId vertex;  // none: not in the mesh
  Position placed;  // where the mesh has it

  // Refused by the mesh; tried again when the node reports another place or the mesh made room.
  Status refusal = Status::ok;
  Position refused_at;
  std::uint32_t refused_epoch = 0;

  bool is_known() const { return serial != no_serial; }
  bool is_placed() const { return !vertex.is_none(); }
};

// One record for each unit, so the memory is fixed when the units are.
class Roster {
 public:
  explicit Roster(std::uint32_t unit_count);

  NodeRecord& at(std::uint32_t unit) { return records_[unit]; }
  std::span<NodeRecord> records() { return records_; }
  std::span<const NodeRecord> records() const { return records_; }

  // The record of a serial, or null.
  NodeRecord* find(std::uint32_t serial);
  std::uint32_t unit_of(const NodeRecord& record) const;

  // REQUIRES: nobody is known at the unit, and the serial at no unit.
  void bind(std::uint32_t unit, std::uint32_t serial);
  // The node now answers at another unit, where nobody is known.
  void move(NodeRecord& record, std::uint32_t unit);
  void release(NodeRecord& record);

 private:
  struct Entry {
    std::uint32_t serial;
    std::uint32_t unit;
  };
  std::vector<Entry>::iterator lower_bound(std::uint32_t serial);

  std::vector<NodeRecord> records_;  // by unit
  std::vector<Entry> by_serial_;     // sorted
};

}  // namespace etcm::firmware
