// Which part of the mesh is the domain: inside its exterior feature and outside its holes.
#pragma once

#include <cstdint>
#include <span>

#include "etcm/mesh.h"

namespace etcm {
inline namespace ETCM_IDS {

enum class Region : std::uint8_t { inside, outside, hole };

enum class Exterior : std::uint8_t {
  hull,      // everything within the convex hull is domain
  features,  // closed features bound it (the paper's B0): what can be reached from outside the hull
             // without crossing a feature is outside
  automatic,  // features, where every node is on or within closed features; else hull
};

// Labels each triangle of the mesh: region[i] is that of TriangleId i; ghosts are outside. A hole
// is what can be reached from a seed without crossing a feature (Triangle's .poly holes).
// `region` needs triangle_count() elements, `scratch` as many; else buffer_too_small, and nothing
// is written. Twice vertices_max are always enough. A seed may be any point; one that lies outside
// the hull, or on a feature, labels nothing. O(n).
Status label_domain(const Mesh& mesh, Exterior exterior, std::span<const Point> hole_seeds,
                    std::span<Region> region, std::span<TriangleId> scratch) noexcept;

}  // namespace ETCM_IDS
}  // namespace etcm
