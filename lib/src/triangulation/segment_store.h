// The records of vertices and segments: allocation, incidence, grids.
#pragma once

#include "etcm/policy.h"
#include "triangulation/mesh_state.h"

namespace etcm::internal {

// The least free one; none: no room.
VertexId allocate_vertex(MeshState& m) noexcept;
void free_vertex(MeshState& m, VertexId v) noexcept;
SegmentId allocate_segment(MeshState& m) noexcept;
void free_segment(MeshState& m, SegmentId s) noexcept;
// For how many there is room.
std::uint32_t segments_left(const MeshState& m) noexcept;
// Ids from these on, all of them free, count as never used. O(n log n) of n free ids where an end
// changes.
void lower_ends(MeshState& m, IdValue vertex_end, IdValue segment_end) noexcept;
// Into and out of the incidence lists of its two ends.
void link_segment(MeshState& m, SegmentId s) noexcept;
void unlink_segment(MeshState& m, SegmentId s) noexcept;
bool is_free(const MeshState& m, SegmentId s) noexcept;
// Whether it is in them: part of a feature that lies in the mesh.
bool is_linked(const MeshState& m, SegmentId s) noexcept;
SegmentId next_at(const MeshState& m, SegmentId s, VertexId node) noexcept;
// The segment that has a subsegment between u and v, and is not `except`. O(1), but if both are
// nodes the features at u or at v, whichever are fewer.
SegmentId segment_of_edge(const MeshState& m, VertexId u, VertexId v,
                          SegmentId except = SegmentId::none()) noexcept;
bool is_feature(const MeshState& m, FeatureId feature) noexcept;
FeatureId feature_of(const MeshState& m, SegmentId s) noexcept;
// Canonical order: by the lexicographically smaller end, then by the greater.
bool precedes(const MeshState& m, SegmentId a, SegmentId b) noexcept;
// Node v, on segment s, cuts it in two: s ends there and `rest` takes over. And back.
void cut_segment(MeshState& m, SegmentId s, VertexId v, SegmentId rest) noexcept;
void rejoin_segments(MeshState& m, SegmentId s, SegmentId rest) noexcept;

// The place of a parameter on a segment's grid, and the reverse for a vertex on it.
Point point_at(const MeshState& m, SegmentId s, Parameter t) noexcept;
Parameter parameter_of(const MeshState& m, SegmentId s, VertexId v) noexcept;

}  // namespace etcm::internal
