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
// The first ones along all of it, spread by a hash; none: in one round. The quick ones are the best
// as a rule, the even ones at worst.
enum class Rounds : std::uint8_t { none, quick, even };
OrderEntry* hilbert_order(MeshState& m, Rounds rounds = Rounds::quick) noexcept;

}  // namespace etcm::internal
