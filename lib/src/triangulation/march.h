// Along a straight line through the mesh, from vertex to vertex.
#pragma once

#include "triangulation/mesh_state.h"

namespace etcm::internal {

// A way along a line is looked for in so many turns around its head. Most vertices have fewer
// neighbours; where there are more it is looked for from the other end, which mostly takes no more
// steps than this, and else all around.
inline constexpr std::uint32_t turns_few = 24;
inline constexpr std::uint32_t steps_back_most = 256;
// Around a Steiner vertex so many edges are asked for their mark in a step.
inline constexpr std::uint32_t marks_a_step = 8;

// The segment from a vertex to the next vertex on the way to another, in whose direction it looks.
struct Subsegment {
  VertexId head{};
  VertexId tail{};
  bool is_edge = false;
  Edge edge{};              // is_edge: head -> tail
  Edge head_edge{};         // else: opposite head in its triangle that the segment enters, and
  Edge tail_edge{};         // opposite tail in the triangle by which it arrives
  Edge constrained{};       // an edge of a feature that it crosses, if any
  std::uint32_t steps = 0;  // triangles on the way; more than were allowed: it was given up
};
Subsegment march(const MeshState& m, VertexId head, VertexId toward, Walk walk = {}) noexcept;
// The next vertex, in the work that is left; `toward` where there is none left.
VertexId march_counted(MeshState& m, VertexId head, VertexId toward) noexcept;
// The same where the next vertex is known and the segment is no subsegment: looks at both ends
// only, and at nothing it crosses.
Subsegment between(const MeshState& m, VertexId head, VertexId tail, Walk walk = {}) noexcept;

// The subsegments of a Steiner vertex, from it.
struct OwnEdges {
  Edge back;  // to its neighbour that is lexicographically before it; none: it is not marked
  Edge onward;
  std::uint32_t looked = 0;  // edges, at most `turns_most`
};
OwnEdges own_edges(const MeshState& m, VertexId steiner,
                   std::uint32_t turns_most = any_steps) noexcept;

}  // namespace etcm::internal
