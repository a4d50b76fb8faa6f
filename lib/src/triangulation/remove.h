// A vertex out of the canonical triangulation.
#pragma once

#include "triangulation/mesh_state.h"

namespace etcm::internal {

// The work that takes a vertex of this degree out, at most.
constexpr Units removal_work(Units degree) noexcept {
  return degree < 16 ? 4 * degree + 32 : 16 * degree - 160;
}
// Takes the vertex out of the triangulation; its id stays. Edges to it must not be needed. The
// degree is that of the vertex, where there are triangles.
void remove_vertex(MeshState& m, VertexId v, unsigned degree) noexcept;
// The same for a Steiner vertex and its subsegments.
void remove_steiner(MeshState& m, VertexId v) noexcept;

}  // namespace etcm::internal
