// audit: is this mesh what mesh.h promises? For tests, and for users who want proof.
#pragma once

#include <cstdint>

#include "etcm/mesh.h"

namespace etcm {
inline namespace ETCM_IDS {

enum class Rule : std::uint8_t {
  none,         // all hold
  counts,       // triangles = 2 * vertices - 2; Euler's formula
  links,        // neighbours know each other and share the edge, both ways, with its mark
  incidence,    // each vertex knows a triangle that has it as a corner
  orientation,  // finite triangles are counter-clockwise and not flat
  hull,         // the ghosts' edges bound a convex region
  delaunay,     // no vertex strictly inside a neighbouring circumcircle
  canonical,    // ties are broken by features first, then by the perturbation
  on_feature,   // each Steiner vertex lies exactly on its feature, on that feature's grid
  conforming,  // each feature is a union of edges, but for what Mesh::unresolved() counts, and only
               // its edges are marked
};

struct Audit {
  Rule broken = Rule::none;  // the first broken rule
  VertexId vertex{};         // where, as far as it applies
  TriangleId triangle{};
  FeatureId feature{};
  explicit operator bool() const noexcept { return broken == Rule::none; }
};

[[nodiscard]] const char* to_string(Rule rule) noexcept;

// Checks every rule in the order of the enumeration, with exact predicates throughout.
// O(n * degree); no memory.
[[nodiscard]] Audit audit(const Mesh& mesh) noexcept;

}  // namespace ETCM_IDS
}  // namespace etcm
