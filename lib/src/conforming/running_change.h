// What a change takes out of the mesh until it succeeds or is undone.
#pragma once

#include "triangulation/mesh_state.h"

namespace etcm::internal {

void begin(MeshState& m) noexcept;
// Takes a Steiner vertex out of the mesh, to be put back by restore_detached().
void detach(MeshState& m, VertexId steiner) noexcept;
// The segments of Steiner vertices next to v, which may become needless without it.
void touch_around(MeshState& m, VertexId v) noexcept;
// Detaches all Steiner vertices of a segment (drops the fresh) and takes the marks off its edges.
void strip_segment(MeshState& m, SegmentId s) noexcept;
// Drops the fresh Steiner vertices of all touched segments.
void drop_fresh(MeshState& m) noexcept;

}  // namespace etcm::internal
