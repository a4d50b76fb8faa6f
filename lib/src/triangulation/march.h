// Along a straight line through the mesh, from vertex to vertex.
#pragma once

#include "triangulation/mesh_state.h"

namespace etcm::internal {

// The segment from a vertex to the next vertex on the way to another, in whose direction it looks.
struct Subsegment {
  VertexId head{};
  VertexId tail{};
  bool is_edge = false;
  Edge edge{};         // is_edge: head -> tail
  Edge head_edge{};    // else: opposite head in its triangle that the segment enters, and
  Edge tail_edge{};    // opposite tail in the triangle by which it arrives
  Edge constrained{};  // an edge of a feature that it crosses, if any
};
Subsegment march(const MeshState& m, VertexId head, VertexId toward) noexcept;
// The same where the next vertex is known and the segment is no subsegment: looks at both ends
// only, and at nothing it crosses.
Subsegment between(const MeshState& m, VertexId head, VertexId tail) noexcept;

// The subsegments of a Steiner vertex, from it.
struct OwnEdges {
  Edge back;  // to its neighbour that is lexicographically before it; none: it is not marked
  Edge onward;
};
OwnEdges own_edges(const MeshState& m, VertexId steiner) noexcept;

}  // namespace etcm::internal
