// What a split would cost its surroundings.
#pragma once

#include "mesh_internal.h"

namespace etcm::internal {

// Counts what vertices at several places of one piece would break: the subsegments between two
// triangles whose circles both hold the place. The mesh must not change meanwhile.
class HarmCount {
 public:
  explicit HarmCount(const MeshState& m) noexcept : m_(m) {}

  // Stops at `enough`, and says that too where p is no place for a vertex. Starts to look for p at
  // `near`. O(the triangles around p that it would change); a few hundred bytes of stack.
  unsigned at(const Point& p, Edge near, unsigned enough) noexcept;

 private:
  unsigned count_known(const Point& p) const noexcept;
  void remember(Edge subsegment) noexcept;

  // What one place breaks, the next one often breaks too, and asking that is cheaper than looking
  // around.
  static constexpr unsigned remembered_most = 4;
  const MeshState& m_;
  Edge remembered_[remembered_most];
  unsigned remembered_count_ = 0;
};

}  // namespace etcm::internal
