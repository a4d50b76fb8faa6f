// What a split policy sees: a missing subsegment of a feature and its surroundings. For who writes
// one.
#pragma once

#include "etcm/mesh.h"
#include "etcm/policy.h"

namespace etcm {
inline namespace ETCM_IDS {

// The subsegment runs from the vertex `head` to the vertex `tail` on one segment between two nodes;
// head has the smaller parameter. No vertex lies between, and the subsegment is no Delaunay edge.
struct SplitSite {
  // The grid: parameter t stands at from * 2^28 + t * (to - from).
  Position from;
  Position to;
  Parameter head = 0;
  Parameter tail = parameter_end;
  // Feasible sets (paper, section 3): a split in (head, feasible_head] makes head's part a Delaunay
  // edge, one in [feasible_tail, tail) tail's part, one in both finishes the subsegment. Exact: one
  // grid step further and it would not. feasible_head may equal head, feasible_tail tail (a very
  // narrow angle on a very short subsegment): then that set is empty.
  Parameter feasible_head = 0;
  Parameter feasible_tail = parameter_end;
  // The ends of the edge that the subsegment crosses first, seen from head and from tail: right and
  // left of the direction from `from` to `to`.
  Point head_right, head_left;
  Point tail_right, tail_left;
  // Whether each end of the subsegment is a node (else a Steiner vertex).
  bool head_is_node = false;
  bool tail_is_node = false;
  // Whether nothing of another feature is near the segment: then the farthest that a split finishes
  // is the best, as there is nobody to make room for.
  bool is_lone = false;
  // The mesh as it stands, and the triangles by which the subsegment leaves head and arrives at
  // tail: for rules that look further (surroundings.h).
  const Mesh* mesh = nullptr;
  TriangleId head_triangle{};
  TriangleId tail_triangle{};
  // MeshConfig::policy_context of that mesh.
  void* context = nullptr;

  [[nodiscard]] constexpr Point at(Parameter t) const noexcept {
    return {from.x * subunits_per_unit + t * (static_cast<std::int64_t>(to.x) - from.x),
            from.y * subunits_per_unit + t * (static_cast<std::int64_t>(to.y) - from.y)};
  }
};

}  // namespace ETCM_IDS
}  // namespace etcm
