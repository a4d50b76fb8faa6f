// A vertex into the canonical triangulation.
#pragma once

#include "triangulation/change.h"
#include "triangulation/locate.h"

namespace etcm::internal {

// Of an edge that an insertion turns, with the triangles beyond it and beside it, whose circles
// wide integers may have to settle: 13 000 instructions on a Cortex-M0+.
inline constexpr Units work_of_flip = 13;

// Puts the vertex (its point is set) where `found` says. Subsegments that are no longer Delaunay
// are broken, and their segments become dirty. False: the limit of the work does not allow it, and
// nothing has changed; it cannot fail otherwise.
[[nodiscard]] bool insert_vertex(Change& change, VertexId v, const Found& found) noexcept;
// Flips what must_flip() says of the edges that face p, the corner opposite e: from e
// counter-clockwise, up to the one that ends in `last`. With a change subsegments are broken; else
// marked edges stay. Returns how many it has flipped.
std::uint32_t legalize_link(MeshState& m, Edge e, VertexId last, const Point& p,
                            Change* change) noexcept;
// True where p is in conflict with the ghost behind the hull edge u -> v (to its left): strictly
// outside, or on the edge itself.
bool conflicts_with_ghost(const MeshState& m, VertexId u, VertexId v, const Point& p) noexcept;
// True where p, a new or moved vertex, belongs inside the circle of the triangle beyond e.
bool must_flip(const MeshState& m, Edge e, const Point& p) noexcept;

}  // namespace etcm::internal
