// Which of the triangulations of cocircular points is the canonical one.
#pragma once

#include "triangulation/march.h"
#include "triangulation/mesh_state.h"

namespace etcm::internal {

// Flips the edges that a segment crosses, all of whose ends lie on one empty circle with it, so
// that it becomes an edge; returns it.
Edge flip_in(MeshState& m, const Subsegment& subsegment) noexcept;
// Marks an edge as a subsegment, and brings the ties beside it to their canonical form.
void constrain(MeshState& m, Edge e) noexcept;
// The reverse.
void release_constraint(MeshState& m, Edge e) noexcept;

}  // namespace etcm::internal
