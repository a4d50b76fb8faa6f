// Which features are at a node, and which one an edge is part of.
#pragma once

#include <cstdint>
#include <span>

#include "etcm/mesh.h"

namespace etcm {
inline namespace ETCM_IDS {

struct FeatureAt {
  FeatureId feature{};
  bool is_end = false;  // the feature ends at the vertex; else it runs through
};

// Writes the features that end at a vertex or run through it, each once, with increasing ids, as
// many as fit (then those with the least), and returns how many there are. Those at a node may be
// many or none; through a Steiner vertex runs the one it stands on. In a mesh that an unresolved
// build() has left also features that are no edges yet. `vertex` must be in use, else it is a
// programming error (illegal_argument.h). O(d log d), d the features at the vertex; less than
// 300 bytes of stack.
[[nodiscard]] std::uint32_t features_at(const Mesh& mesh, VertexId vertex,
                                        std::span<FeatureAt> out) noexcept;

// The feature that the edge between two neighbouring vertices is part of; none where it is part of
// none, or where the two are no neighbours. In any order; both must be in use, as above. O(degree
// of `from` and features at it); less than 200 bytes of stack.
[[nodiscard]] FeatureId feature_between(const Mesh& mesh, VertexId from, VertexId to) noexcept;

}  // namespace ETCM_IDS
}  // namespace etcm
