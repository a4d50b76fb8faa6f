// The convex hull, by itself: verify must not ask the library that made the mesh.
#pragma once

#include <span>
#include <vector>

#include "etcm/files/outline.h"

namespace etcm::cli {

// Its edges counter-clockwise, divided at every point on them; sorted. Empty where all points are
// collinear. The points must be distinct.
std::vector<files::DirectedEdge> hull_edges(std::span<const Point> points);

}  // namespace etcm::cli
