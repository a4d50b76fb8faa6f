// What a split policy sees: a missing piece of a feature and its surroundings. For who writes one.
#pragma once

#include "etcm/mesh.h"
#include "etcm/policy.h"

namespace etcm {

// The piece runs from the vertex `head` to the vertex `tail` on one stretch between two nodes; head
// has the smaller parameter. No vertex lies between, and the piece is no Delaunay edge.
struct SplitSite {
  // The grid: parameter t stands at from * 2^28 + t * (to - from).
  Position from;
  Position to;
  Parameter head = 0;
  Parameter tail = parameter_end;
  // Feasible sets (paper, section 3): a split in (head, reach_head] makes head's part a Delaunay
  // edge, one in [reach_tail, tail) tail's part, one in both finishes the piece. Exact: one grid
  // step further and it would not. reach_head may equal head, reach_tail tail (a very narrow angle
  // on a very short piece): then that set is empty.
  Parameter reach_head = 0;
  Parameter reach_tail = parameter_end;
  // The ends of the edge that the piece crosses first, seen from head and from tail: right and left
  // of the direction from `from` to `to`.
  Point head_right, head_left;
  Point tail_right, tail_left;
  // Whether each end of the piece is a node (else a Steiner vertex).
  bool head_is_node = false;
  bool tail_is_node = false;
  // The mesh as it stands, and the triangles by which the piece leaves head and arrives at tail:
  // for rules that look further.
  const Mesh* mesh = nullptr;
  TriangleId head_triangle{};
  TriangleId tail_triangle{};

  constexpr Point at(Parameter t) const noexcept {
    return {from.x * subunits_per_unit + t * (static_cast<std::int64_t>(to.x) - from.x),
            from.y * subunits_per_unit + t * (static_cast<std::int64_t>(to.y) - from.y)};
  }
};

}  // namespace etcm
