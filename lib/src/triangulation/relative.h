// A vertex as a place sees it: what every test of a circle against that place needs, worked out
// once.
#pragma once

#include "geometry/predicates_inline.h"
#include "triangulation/mesh_state.h"

namespace etcm::internal {

// What the infinite vertex has in `at` and `height` is never used.
struct Relative {
  VertexId id;
  Offset at;
  double height;
};

inline Relative relative_to(const MeshState& m, VertexId v, const Point& p) noexcept {
  // Nobody asks where doubles are computed in software: what decides there takes the points.
  if (!has_double_unit || v == infinite_vertex) return {v, {0, 0}, 0};
  const Offset at = offset(m.at(v), p);
  return {v, at, lift(at)};
}

}  // namespace etcm::internal
