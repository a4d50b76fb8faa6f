#include "lower_bound.h"

#include <vector>

#include "etcm/bound.h"
#include "etcm/files/error.h"
#include "etcm/traverse.h"
#include "inputs/owned_mesh.h"

namespace etcm::cli {
namespace {

std::uint64_t sum_of_least(const std::vector<Position>& nodes,
                           const std::vector<FeatureEnds>& features) {
  MeshConfig config;
  config.vertices_max = static_cast<std::uint32_t>(nodes.size() + 1);
  config.features_max = 1;
  inputs::OwnedMesh mesh(config);
  if (mesh.opened() != Status::ok || mesh->build(nodes, {}) != Status::ok) {
    throw files::InputError("no mesh of these nodes to count in");
  }
  std::uint64_t sum = 0;
  for (const FeatureEnds& feature : features) sum += least_steiner(*mesh, feature);
  return sum;
}

}  // namespace

std::uint64_t least_steiner_of(const files::GridGraph& grid) {
  return sum_of_least(grid.nodes, grid.features);
}

std::uint64_t least_steiner_of(const Mesh& mesh) {
  std::vector<Position> nodes;
  std::vector<VertexId> place_of(mesh.vertex_id_end());
  for (const VertexId node : nodes_of(mesh)) {
    nodes.push_back(mesh.position(node));
    place_of[node.value] = VertexId{static_cast<IdValue>(nodes.size())};
  }
  std::vector<FeatureEnds> features;
  for (const FeatureId feature : features_of(mesh)) {
    const FeatureEnds ends = mesh.ends(feature);
    features.push_back({place_of[ends.from.value], place_of[ends.to.value]});
  }
  return sum_of_least(nodes, features);
}

std::string describe_bound(std::uint64_t least, std::uint64_t steiner) {
  return least == steiner ? "no mesh has fewer" : "no mesh has fewer than " + std::to_string(least);
}

}  // namespace etcm::cli
