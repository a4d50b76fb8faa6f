// What a split would cost its surroundings.
#pragma once

#include "mesh_internal.h"

namespace etcm::internal {

// How many subsegments a vertex at p would break: those between two triangles whose circles hold p.
// Stops counting at `enough`, and there too where p is no place for a vertex. Starts to look for p
// at `near`. O(the triangles around p that it would change); a few hundred bytes of stack.
unsigned count_harm(const MeshState& m, const Point& p, Edge near, unsigned enough) noexcept;

}  // namespace etcm::internal
