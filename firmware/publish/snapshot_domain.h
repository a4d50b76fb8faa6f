// Which triangles of a snapshot belong to the domain, as etcm/domain.h has it
// (Exterior::automatic).
//
// The generation itself does not tell: most are never written to files, which alone need it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "etcm/config.h"
#include "firmware/publish/snapshot.h"

namespace etcm::firmware {

class SnapshotDomain {
 public:
  // All the memory it ever needs is taken here.
  explicit SnapshotDomain(const MeshConfig& config);

  // O(n), and O(degree^2) of each vertex.
  void label(const Snapshot& snapshot);
  // Whether a triangle of the domain is on the left of this edge, an index into
  // Snapshot::neighbours. REQUIRES: label() of the same snapshot.
  bool has_on_left(std::size_t edge) const { return left_[edge] == Left::inside; }

 private:
  enum class Left : std::uint8_t { inside, outside, beyond_hull };

  void link_edges(const Snapshot& snapshot);
  void flood_from_hull(const Snapshot& snapshot);
  void mark_outside(std::uint32_t edge);
  bool leaves_a_node_outside(const Snapshot& snapshot) const;

  // By edge.
  std::vector<Left> left_;
  std::vector<std::uint32_t> twin_;  // the same one in the other direction
  std::vector<std::uint32_t> next_;  // around what is on the left
  std::vector<std::uint32_t> waiting_;
};

}  // namespace etcm::firmware
