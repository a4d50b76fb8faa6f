// Lists of segments: those with missing subsegments, and those that the running change has touched.
#pragma once

#include "triangulation/mesh_state.h"

namespace etcm::internal {

// The running change may have to put the segment back: all of it, or from u to v.
void touch(MeshState& m, SegmentId s) noexcept;
void touch(MeshState& m, SegmentId s, VertexId u, VertexId v) noexcept;
// Into the list of work, for the part that is touched; and the first of that list.
void make_dirty(MeshState& m, SegmentId s) noexcept;
SegmentId pop_dirty(MeshState& m) noexcept;
void clear_dirty(MeshState& m) noexcept;
// Brings a list linked by next_dirty into canonical order.
SegmentId sort_segments(MeshState& m, SegmentId list) noexcept;
// Takes all segments off the list of touched ones.
void clear_touched(MeshState& m) noexcept;

}  // namespace etcm::internal
