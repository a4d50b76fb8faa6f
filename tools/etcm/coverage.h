// The second half of conformity.h: the triangles.
#pragma once

#include <optional>
#include <string>

#include "conformity.h"

namespace etcm::cli {

// In words, the first broken rule, or none: triangles are counter-clockwise; no vertex of the whole
// mesh is strictly inside the circumcircle of any; each side of an edge has one triangle at most;
// around a vertex they do not overlap; subsegments do not cross; the outline is made of hull edges
// and subsegments; what the triangles leave out within them is a hole of the input; no hole of the
// input is covered; Euler's formula, where the domain is the hull. Together these say that the
// triangles are the Delaunay triangulation of the domain, each place covered once.
std::optional<std::string> first_triangle_violation(const Claim& claim);

}  // namespace etcm::cli
