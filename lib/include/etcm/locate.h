// Where in a mesh a point lies.
#pragma once

#include <cstdint>

#include "etcm/mesh.h"

namespace etcm {
inline namespace ETCM_IDS {

enum class LocateType : std::uint8_t { outside, inside_triangle, on_edge, on_vertex };

struct Location {
  LocateType type = LocateType::outside;
  // inside_triangle: the triangle; on_edge: one of its two; on_vertex: any at the vertex;
  // outside: the ghost behind a hull edge that the point can see. None when there is no triangle,
  // and for a point that is not in range.
  TriangleId triangle{};
  int side = 0;       // on_edge: the edge opposite triangle.corner[side]
  VertexId vertex{};  // on_vertex
};

// Finds `point`, which may be any, by a visibility walk from `near` (none: from a node nearby,
// expected O(1) for nodes spread evenly; ids of no triangle count as none). Never more than one
// visit to each triangle. No stack to speak of.
[[nodiscard]] Location locate(const Mesh& mesh, Point point,
                              TriangleId near = TriangleId::none()) noexcept;

}  // namespace ETCM_IDS
}  // namespace etcm
