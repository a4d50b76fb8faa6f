// What a change takes out of the mesh until it succeeds or is undone.
#pragma once

#include "triangulation/change.h"

namespace etcm::internal {

// Takes a Steiner vertex out of the mesh, to be put back by restore_detached().
void detach(Change& change, VertexId steiner) noexcept;
// The same, where its neighbours have been touched.
void detach_alone(Change& change, VertexId steiner) noexcept;
// The segments of Steiner vertices next to v, which may become needless without it.
void touch_around(Change& change, VertexId v) noexcept;
// Detaches all Steiner vertices of a segment (drops the fresh) and takes the marks off its edges.
void strip_segment(Change& change, SegmentId s) noexcept;
// Drops the fresh Steiner vertices of all touched segments.
void drop_fresh(Change& change) noexcept;

}  // namespace etcm::internal
