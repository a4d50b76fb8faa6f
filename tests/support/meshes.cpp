#include "support/meshes.h"

#include <map>
#include <numeric>
#include <utility>

#include "inputs/random.h"

namespace etcm {

void PrintTo(Status status, std::ostream* out) { *out << to_string(status); }
void PrintTo(Position position, std::ostream* out) {
  *out << '(' << position.x << ", " << position.y << ')';
}

}  // namespace etcm

namespace etcm::test {

std::unique_ptr<OwnedMesh> empty_mesh(std::uint32_t vertices_max, std::uint32_t features_max,
                                      SplitPolicy policy) {
  MeshConfig config;
  config.vertices_max = vertices_max;
  config.features_max = features_max;
  config.policy = policy;
  auto mesh = std::make_unique<OwnedMesh>(config);
  EXPECT_EQ(mesh->opened(), Status::ok);
  return mesh;
}

std::unique_ptr<OwnedMesh> built(const Graph& graph, SplitPolicy policy, std::size_t steiner_room) {
  auto mesh = std::make_unique<OwnedMesh>(inputs::config_for(graph, steiner_room, policy));
  EXPECT_EQ(mesh->opened(), Status::ok);
  EXPECT_EQ((*mesh)->build(graph.nodes, graph.features), Status::ok) << graph.name;
  return mesh;
}

std::unique_ptr<OwnedMesh> grown(const Graph& graph, SplitPolicy policy, std::size_t steiner_room) {
  auto mesh = std::make_unique<OwnedMesh>(inputs::config_for(graph, steiner_room, policy));
  EXPECT_EQ(mesh->opened(), Status::ok);
  std::vector<VertexId> ids;
  for (const Position node : graph.nodes) {
    VertexId id;
    EXPECT_EQ((*mesh)->join(node, id), Status::ok) << testing::PrintToString(node);
    ids.push_back(id);
  }
  for (const FeatureEnds& feature : graph.features) {
    const FeatureEnds ends{ids[inputs::node_index_of(feature.from)],
                           ids[inputs::node_index_of(feature.to)]};
    FeatureId id;
    EXPECT_EQ((*mesh)->add_feature(ends, id), Status::ok);
  }
  return mesh;
}

Picture picture_of(const Mesh& mesh) {
  Picture picture;
  picture.hash = mesh.hash();
  for (IdValue value = 1; value < mesh.vertex_id_end(); ++value) {
    const VertexId vertex{value};
    const VertexKind kind = mesh.kind(vertex);
    if (kind != VertexKind::none) picture.vertices.push_back({vertex, kind, mesh.point(vertex)});
  }
  for (IdValue value = 0; value < mesh.feature_id_end(); ++value) {
    const FeatureId feature{value};
    if (!mesh.is_feature(feature)) continue;
    picture.features.push_back({feature, mesh.ends(feature).from, mesh.ends(feature).to});
  }
  return picture;
}

Graph graph_of(const Mesh& mesh) {
  Graph graph;
  std::map<VertexId, std::size_t> index;
  for (IdValue value = 1; value < mesh.vertex_id_end(); ++value) {
    const VertexId vertex{value};
    if (mesh.kind(vertex) != VertexKind::node) continue;
    index[vertex] = graph.nodes.size();
    graph.nodes.push_back(mesh.position(vertex));
  }
  for (IdValue value = 0; value < mesh.feature_id_end(); ++value) {
    if (!mesh.is_feature(FeatureId{value})) continue;
    const FeatureEnds ends = mesh.ends(FeatureId{value});
    graph.features.push_back(between_nodes(index.at(ends.from), index.at(ends.to)));
  }
  return graph;
}

Graph shuffled(const Graph& graph, std::uint64_t seed) {
  inputs::Random random(seed);
  std::vector<std::size_t> order(graph.nodes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  inputs::shuffle(order, random);
  Graph result{graph.name + " shuffled", {}, {}};
  std::vector<std::size_t> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    result.nodes.push_back(graph.nodes[order[i]]);
    place[order[i]] = i;
  }
  for (std::size_t i = 0; i < graph.features.size(); ++i) {
    std::size_t from = place[inputs::node_index_of(graph.features[i].from)];
    std::size_t to = place[inputs::node_index_of(graph.features[i].to)];
    if (i % 2 == 0) std::swap(from, to);
    result.features.push_back(between_nodes(from, to));
  }
  inputs::shuffle(result.features, random);
  return result;
}

std::vector<VertexId> steiner_vertices(const Mesh& mesh) {
  std::vector<VertexId> found;
  for (IdValue value = 1; value < mesh.vertex_id_end(); ++value) {
    if (mesh.kind(VertexId{value}) == VertexKind::steiner) found.push_back(VertexId{value});
  }
  return found;
}

}  // namespace etcm::test
