// Which nodes stand nearest to a place.
//
// Distances are between points, whatever features lie in between, and exact. Of nodes as far away
// the lexicographically first (types.h) comes first, so an answer depends on what stands where, not
// on ids or on how the mesh came about. Steiner vertices are passed over. The coordinates of a
// place are at most 2^52 in magnitude, as those of a mesh, which is not checked: beyond, the answer
// may be wrong. It may be outside of the hull.
//
// Any mesh will do: of one node, of nodes on one line, or what an unresolved build() has left. An
// empty one has no nodes, near or far.
//
// The search goes from locate() to the nearest vertex and from there to vertices next to others
// that it has met. Memory is what the caller gives and less than 1 KiB of stack.
#pragma once

#include <cstdint>
#include <span>

#include "etcm/length.h"
#include "etcm/mesh.h"

namespace etcm {
inline namespace ETCM_IDS {

struct NearNode {
  VertexId node{};
  SquaredLength distance{};
};

// The nearest node; none in an empty mesh. Costs what nearest_nodes() does for one.
[[nodiscard]] VertexId nearest_node(const Mesh& mesh, Point place) noexcept;

// Writes the nearest nodes, as many as fit, the nearest first, and returns how many it has written:
// fewer than out.size() only where the mesh has no more nodes. For nodes spread evenly expected
// locate() + O(k log k), k being what is written and the Steiner vertices that are no farther.
// Worst, as where all nodes are near one circle: O(n log n) and the squares of their degrees.
[[nodiscard]] std::uint32_t nearest_nodes(const Mesh& mesh, Point place,
                                          std::span<NearNode> out) noexcept;

// Writes the nodes that are no farther than `range`, in user units, as many as fit, the nearest
// first, and returns how many there are. Range 0 is a range: a node may stand at the place. The
// cost is that of as many nearest nodes, counted or written.
[[nodiscard]] std::uint32_t nodes_within(const Mesh& mesh, Point place, std::uint32_t range,
                                         std::span<NearNode> out) noexcept;

}  // namespace ETCM_IDS
}  // namespace etcm
