// The Delaunay triangulation by CGAL, whose kernel is exact on doubles, and every coordinate of a
// mesh is one. No CGAL type leaves this header.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "etcm/types.h"

namespace etcm::test {

inline constexpr std::size_t no_point = std::numeric_limits<std::size_t>::max();

// Indices of points. Where nothing lies beyond an edge its apex there is no_point.
struct DelaunayEdge {
  std::size_t from;
  std::size_t to;
  std::size_t apex;
  std::size_t other_apex;
};

std::vector<DelaunayEdge> cgal_delaunay_edges(std::span<const Point> points);

}  // namespace etcm::test
