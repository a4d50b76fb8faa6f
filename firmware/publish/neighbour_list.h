// Whom a node is next to, as it is told: by serial.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "etcm/mesh.h"

namespace etcm::firmware {

// The nodes that an edge of the mesh joins to it, and, where a feature leads from it to a Steiner
// vertex, the next node on that feature: a Steiner vertex has no serial and is only a proposal for
// a relay, but along the feature nobody stands between the two. Other Steiner vertices are left
// out.
class NeighbourList {
 public:
  // All the memory it needs is taken here.
  explicit NeighbourList(std::uint32_t vertices_max);

  // Ascending, each once; good until the next call. `serials` is by vertex id. O(degree, and the
  // length of the features that leave the node).
  std::span<const std::uint32_t> of(const Mesh& mesh, VertexId node,
                                    std::span<const std::uint32_t> serials);

 private:
  VertexId end_of_stretch(const Mesh& mesh, VertexId from, VertexId over);

  std::vector<Neighbour> around_;
  std::vector<Neighbour> around_steiner_;
  std::vector<std::uint32_t> list_;
};

}  // namespace etcm::firmware
