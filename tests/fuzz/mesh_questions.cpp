#include "mesh_questions.h"

#include <array>
#include <vector>

#include "etcm/incidence.h"
#include "etcm/locate.h"
#include "etcm/nearest.h"
#include "etcm/traverse.h"
#include "inputs/owned_mesh.h"

namespace etcm::fuzz {
namespace {

// Beyond what a mesh can hold too, which locate() takes.
Point place_of(Input& input) {
  const auto x = static_cast<std::int64_t>(input.number());
  const auto y = static_cast<std::int64_t>(input.number());
  const int shift = input.byte() % 32;
  return {(x - 0x8000'0000) * (std::int64_t{1} << shift),
          (y - 0x8000'0000) * (std::int64_t{1} << shift)};
}

void check_neighbours(const Mesh& mesh, VertexId vertex) {
  std::vector<Neighbour> around(mesh.neighbours(vertex, {}));
  require(mesh.neighbours(vertex, around) == around.size(), "neighbours() counts otherwise");
  for (const Neighbour& next : around) {
    const FeatureId feature = feature_between(mesh, vertex, next.vertex);
    require(feature.is_none() != next.constrained, "an edge is constrained by no feature");
  }
}

void check_features_at(const Mesh& mesh, VertexId vertex) {
  std::vector<FeatureAt> at(features_at(mesh, vertex, {}));
  require(features_at(mesh, vertex, at) == at.size(), "features_at() counts otherwise");
  for (const FeatureAt& one : at) {
    const FeatureEnds ends = mesh.ends(one.feature);
    require(one.is_end == (ends.from == vertex || ends.to == vertex), "an end is none");
  }
}

}  // namespace

void ask_about_places(const Mesh& mesh, Input& input) {
  const Point place = place_of(input);
  const TriangleId near{static_cast<IdValue>(input.byte())};
  const Location at = locate(mesh, place, near);
  if (at.type == LocateType::on_vertex) {
    require(mesh.point(at.vertex) == place, "locate() answers with another vertex");
  }
  if (!in_range(place)) return;
  std::array<NearNode, 5> out;
  const std::uint32_t found = nearest_nodes(mesh, place, out);
  require(found == std::min<std::uint32_t>(out.size(), mesh.node_count()), "nearest_nodes()");
  const VertexId nearest = nearest_node(mesh, place);
  require(nearest.is_none() ? found == 0 : out[0].node == nearest, "nearest_node()");
  const std::uint32_t range = input.number();
  require(nodes_within(mesh, place, range, out) <= mesh.node_count(), "nodes_within()");
}

void ask_about_nodes(const Mesh& mesh, Input& input) {
  std::uint32_t count = 0;
  for (const VertexId node : nodes_of(mesh)) {
    ++count;
    require(to_point(mesh.position(node)) == mesh.point(node), "a node stands elsewhere");
    const Location at = locate(mesh, mesh.point(node));
    require(at.type == LocateType::on_vertex && at.vertex == node, "locate() misses a node");
    require(nearest_node(mesh, mesh.point(node)) == node, "nearest_node() misses a node");
  }
  require(count == mesh.node_count(), "node_count()");
  if (mesh.vertex_id_end() < 2) return;
  const VertexId vertex{static_cast<IdValue>(1 + input.below(mesh.vertex_id_end() - 1))};
  if (mesh.kind(vertex) == VertexKind::none) return;
  check_neighbours(mesh, vertex);
  check_features_at(mesh, vertex);
}

void ask_about_features(const Mesh& mesh) {
  std::uint32_t count = 0;
  for (const FeatureId feature : features_of(mesh)) {
    ++count;
    if (mesh.unresolved() != 0) continue;
    std::vector<VertexId> along(mesh.chain(feature, {}));
    require(mesh.chain(feature, along) == along.size() && along.size() >= 2, "chain()");
    const FeatureEnds ends = mesh.ends(feature);
    require(along.front() == ends.from && along.back() == ends.to, "chain() has other ends");
    for (std::size_t i = 1; i < along.size(); ++i) {
      require(feature_between(mesh, along[i - 1], along[i]) == feature, "a chain is no edges");
    }
  }
  require(count == mesh.feature_count(), "feature_count()");
}

void save_and_load(const Mesh& mesh) {
  std::vector<std::byte> saved(mesh.saved_bytes());
  const Status status = mesh.save(saved);
  require((status == Status::ok) == (mesh.unresolved() == 0), "save() refuses");
  if (status != Status::ok) return;
  inputs::OwnedMesh other(mesh.config());
  require(other->load(saved) == Status::ok, "load() refuses what save() has written");
  require(other->hash() == mesh.hash(), "load() makes another mesh");
  std::vector<std::byte> again(other->saved_bytes());
  require(other->save(again) == Status::ok && again == saved, "save() writes other bytes");
}

void ask_everything(const Mesh& mesh, Input& input) {
  ask_about_places(mesh, input);
  ask_about_nodes(mesh, input);
  ask_about_features(mesh);
  save_and_load(mesh);
}

}  // namespace etcm::fuzz
