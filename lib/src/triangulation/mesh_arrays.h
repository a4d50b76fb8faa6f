// Where the arrays of a mesh lie in its storage.
#pragma once

#include "triangulation/mesh_state.h"

namespace etcm::internal {

// Of the mesh with these capacities and counts, whose storage begins there. Only addresses: an
// array element is made when its vertex, triangle or segment is.
inline MeshArrays arrays_of(const KeptState& m, std::byte* storage) noexcept {
  std::byte* free = storage + bytes_head;
  const auto take = [&free](std::size_t bytes) noexcept {
    std::byte* const here = free;
    free += bytes;
    return here;
  };
  const std::size_t vertices = m.config.vertices_max + std::size_t{1};
  MeshArrays arrays;
  arrays.points = reinterpret_cast<Point*>(take(vertices * sizeof(Point)));
  auto* const triangles =
      reinterpret_cast<TriangleRecord*>(take(m.config.vertices_max * bytes_per_vertex_triangles));
  arrays.vertex_edges = reinterpret_cast<Edge*>(take(vertices * sizeof(Edge)));
  arrays.owners = reinterpret_cast<Owner*>(take(vertices * sizeof(Owner)));
  arrays.segments =
      reinterpret_cast<SegmentRecord*>(take(m.config.features_max * sizeof(SegmentRecord)));
  arrays.hint_cells = reinterpret_cast<VertexId*>(free);
  const std::uint32_t count = m.node_count + m.steiner_count;
  const std::uint32_t triangle_count = count < 2 ? 0 : 2 * count - 2;
  arrays.topology = Topology(triangles, arrays.vertex_edges, static_cast<IdValue>(triangle_count));
  return arrays;
}

}  // namespace etcm::internal
