// Where a point lies among the triangles.
#pragma once

#include "etcm/locate.h"
#include "triangulation/mesh_state.h"

namespace etcm::internal {

struct Found {
  LocateType type = LocateType::outside;
  Edge edge{};        // inside: an edge of the triangle; on_edge: that edge; outside: see below
  VertexId vertex{};  // on_vertex
  std::uint32_t steps = 0;  // of the walk; more than were allowed: it was given up
};

// Where p lies. outside: `edge` is of the ghost whose hull edge p can see; in a collinear mesh that
// p prolongs it is the edge from the end of the chain to infinity; with fewer than two vertices
// none.
Found find(const MeshState& m, const Point& p, Edge near, Walk walk = {}) noexcept;

// True where all vertices are collinear (and there are at least two). O(1).
bool is_flat(const MeshState& m) noexcept;

}  // namespace etcm::internal
