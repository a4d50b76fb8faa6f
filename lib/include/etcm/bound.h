// How few Steiner vertices a conforming Delaunay mesh can have.
//
// A subsegment of a feature is an edge of a Delaunay mesh only where some circle through its two
// ends has no vertex inside, so no node either. What each feature needs for that among the nodes
// alone, as if there were no other feature, none of its meshes can do without: the sum over the
// features is a lower bound for every conforming Delaunay mesh, whoever made it and wherever its
// Steiner vertices may stand, on a grid or not. Features in each other's way need more.
#pragma once

#include <cstdint>

#include "etcm/mesh.h"

namespace etcm {
inline namespace ETCM_IDS {

// The fewest Steiner vertices with which a feature between two nodes can be a union of edges. From
// one end it goes as far as an edge can each time: a part of what can be an edge can be one too, so
// nothing is less. Exact, but that each vertex is taken to stand less than one step of the
// feature's grid (policy.h) farther than it can: so the answer is never too great, and too small
// only where that step decides.
//
// `nodes` is a mesh without features, of the nodes: that of another mesh cannot be used, because
// its Steiner vertices are in the way. The nodes are two, and the feature need not be one that
// could be added. O(triangles that it crosses, and for each vertex those that one there would
// change). No memory; less than 1.1 KiB of stack.
[[nodiscard]] std::uint32_t least_steiner(const Mesh& nodes, FeatureEnds feature) noexcept;

}  // namespace ETCM_IDS
}  // namespace etcm
