// Where a walk to a point had best begin.
#pragma once

#include "triangulation/mesh_state.h"

namespace etcm::internal {

// Takes in a node that has joined or come back; forget() before it leaves the triangulation.
void add_hint(MeshState& m, VertexId node) noexcept;
void remove_hint(MeshState& m, VertexId node) noexcept;
// For all nodes at once. O(n).
void spread_hints(MeshState& m) noexcept;
// An edge near p.
Edge edge_near(const MeshState& m, const Point& p) noexcept;

}  // namespace etcm::internal
