#include "inputs/owned_mesh.h"

#include <algorithm>

namespace etcm::inputs {

OwnedMesh::OwnedMesh(const MeshConfig& config)
    : storage_(validate(config) == Status::ok ? storage_bytes(config) / sizeof(std::uint64_t) + 1
                                              : 0),
      opened_(mesh_.open(std::as_writable_bytes(std::span(storage_)), config)) {}

MeshConfig config_for(const Graph& graph, std::size_t steiner_room, SplitPolicy policy) {
  const std::size_t vertices = std::max<std::size_t>(graph.nodes.size() + steiner_room, 1);
  // A feature takes one place more for each node it runs through; few nodes lie on one at all.
  const std::size_t segments = graph.features.size() + graph.nodes.size();
  MeshConfig config;
  config.vertices_max = static_cast<std::uint32_t>(std::min<std::size_t>(vertices, vertices_limit));
  config.features_max = static_cast<std::uint32_t>(std::min<std::size_t>(segments, features_limit));
  config.policy = policy;
  return config;
}

}  // namespace etcm::inputs
