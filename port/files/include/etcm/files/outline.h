// The outline of the domain, from its triangles alone.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "etcm/files/mesh_image.h"

namespace etcm::files {

using DirectedEdge = std::pair<std::uint32_t, std::uint32_t>;

// Edges of exactly one triangle, directed so that it lies on the left. Sorted.
std::vector<DirectedEdge> outline_edges(const MeshImage& image);

// The same as closed loops; each edge is in one loop. Where loops touch in a vertex, which of them
// goes on is arbitrary, so fill them with the even-odd rule.
std::vector<std::vector<std::uint32_t>> outline_loops(const MeshImage& image);

}  // namespace etcm::files
