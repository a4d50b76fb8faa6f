// The order in which many nodes are inserted at once.
#pragma once

#include <cstdint>

#include "triangulation/mesh_state.h"

namespace etcm::internal {

// The vertices of the mesh, m.vertex_count() of them and at least one, along a Hilbert curve. Lives
// in the part of the triangle memory that a mesh which grows from nothing reaches last: each entry
// is just read before it is overwritten.
struct OrderEntry {
  std::uint32_t key;
  std::uint32_t vertex;
};
OrderEntry* hilbert_order(MeshState& m) noexcept;

}  // namespace etcm::internal
