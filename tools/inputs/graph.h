// A planar straight-line graph: what Mesh::build() takes, with a name.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "etcm/mesh.h"

namespace etcm::inputs {

// nodes[i] becomes vertex i + 1, as in Mesh::build().
struct Graph {
  std::string name;
  std::vector<Position> nodes;
  std::vector<FeatureEnds> features;
};

constexpr VertexId vertex_of(std::size_t node_index) noexcept {
  return VertexId{static_cast<IdValue>(node_index + 1)};
}
constexpr std::size_t node_index_of(VertexId vertex) noexcept { return vertex.value - 1u; }

constexpr FeatureEnds between_nodes(std::size_t from, std::size_t to) noexcept {
  return {vertex_of(from), vertex_of(to)};
}

}  // namespace etcm::inputs
