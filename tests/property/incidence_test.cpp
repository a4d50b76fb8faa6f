// etcm/incidence.h against the chains of all features.
#include "etcm/incidence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "inputs/corpus.h"
#include "inputs/patterns.h"
#include "support/emulated.h"
#include "support/history.h"
#include "support/meshes.h"

namespace etcm {

bool operator==(const FeatureAt& a, const FeatureAt& b) {
  return a.feature == b.feature && a.is_end == b.is_end;
}
void PrintTo(const FeatureAt& at, std::ostream* out) {
  *out << at.feature.value << (at.is_end ? " ends" : " runs through");
}

}  // namespace etcm

namespace etcm::test {
namespace {

std::vector<FeatureAt> found_at(const Mesh& mesh, VertexId vertex, std::size_t room) {
  std::vector<FeatureAt> found(room);
  found.resize(std::min<std::size_t>(room, features_at(mesh, vertex, found)));
  return found;
}

std::vector<VertexId> chain_of(const Mesh& mesh, FeatureId feature) {
  std::vector<VertexId> chain(mesh.chain(feature, {}));
  EXPECT_EQ(mesh.chain(feature, chain), chain.size());
  return chain;
}

void expect_right_incidence(const Mesh& mesh) {
  std::map<VertexId, std::vector<FeatureAt>> at;
  std::map<std::pair<VertexId, VertexId>, FeatureId> of_edge;
  for (IdValue id = 0; id < mesh.feature_id_end(); ++id) {
    const FeatureId feature{id};
    if (!mesh.is_feature(feature)) continue;
    const std::vector<VertexId> chain = chain_of(mesh, feature);
    for (std::size_t i = 0; i < chain.size(); ++i) {
      at[chain[i]].push_back({feature, i == 0 || i + 1 == chain.size()});
      if (i == 0) continue;
      of_edge[{chain[i - 1], chain[i]}] = feature;
      of_edge[{chain[i], chain[i - 1]}] = feature;
    }
  }
  for (IdValue id = 1; id < mesh.vertex_id_end(); ++id) {
    const VertexId v{id};
    if (mesh.kind(v) == VertexKind::none) continue;
    std::vector<FeatureAt> expected = at[v];
    EXPECT_EQ(features_at(mesh, v, {}), expected.size());
    EXPECT_EQ(found_at(mesh, v, expected.size() + 2), expected) << "vertex " << id;
    if (expected.size() > 1) {
      expected.pop_back();
      EXPECT_EQ(found_at(mesh, v, expected.size()), expected) << "vertex " << id;
    }
    EXPECT_EQ(feature_between(mesh, v, v), FeatureId::none());
    std::vector<Neighbour> neighbours(mesh.neighbours(v, {}));
    ASSERT_EQ(mesh.neighbours(v, neighbours), neighbours.size());
    for (const Neighbour& other : neighbours) {
      const auto edge = of_edge.find({v, other.vertex});
      ASSERT_EQ(edge != of_edge.end(), other.constrained);
      const FeatureId expected_feature = other.constrained ? edge->second : FeatureId::none();
      EXPECT_EQ(feature_between(mesh, v, other.vertex), expected_feature);
    }
  }
}

TEST(Incidence, OfOneNode) {
  const auto mesh = grown({"", {{1, 2}}, {}});
  EXPECT_EQ(features_at(**mesh, vertex_of(0), {}), 0u);
  EXPECT_EQ(feature_between(**mesh, vertex_of(0), vertex_of(0)), FeatureId::none());
}

TEST(Incidence, OfNodesOnALine) {
  expect_right_incidence(**built(inputs::collinear(12, 3)));
  expect_right_incidence(**grown({"", {{0, 0}, {9, 9}}, {between_nodes(1, 0)}}));
}

// Two features end where a third one runs through; and places apart are no edge.
TEST(Incidence, TellsEndsFromWhatRunsThrough) {
  const auto mesh = built({"",
                           {{0, 0}, {10, 0}, {5, 0}, {5, 8}, {5, -8}},
                           {between_nodes(3, 2), between_nodes(1, 0), between_nodes(2, 4)}});
  const std::vector<FeatureAt> expected{
      {FeatureId{0}, true}, {FeatureId{1}, false}, {FeatureId{2}, true}};
  EXPECT_EQ(found_at(**mesh, vertex_of(2), 9), expected);
  EXPECT_EQ(feature_between(**mesh, vertex_of(0), vertex_of(2)), FeatureId{1});
  EXPECT_EQ(feature_between(**mesh, vertex_of(0), vertex_of(1)), FeatureId::none());
  EXPECT_EQ(feature_between(**mesh, vertex_of(3), vertex_of(4)), FeatureId::none());
}

TEST(Incidence, IsThatOfTheChains) {
  constexpr std::size_t nodes_most = is_slow ? 100 : 1000;
  for (const inputs::CorpusEntry& entry : inputs::corpus()) {
    if (entry.graph.nodes.size() > nodes_most || entry.family == "nearly collinear") continue;
    SCOPED_TRACE(entry.graph.name);
    OwnedMesh mesh(inputs::config_for(entry.graph, 12'000));
    ASSERT_EQ(mesh.opened(), Status::ok);
    if (mesh->build(entry.graph.nodes, entry.graph.features) == Status::ok) {
      expect_right_incidence(*mesh);
    }
  }
}

TEST(Incidence, IsThatOfTheChainsWhileAMeshChanges) {
  const auto mesh = empty_mesh(400, 60);
  History history(**mesh, 20, 40, 23, Course::eventful);
  for (int step = 0; step < (is_slow ? 60 : 600); ++step) {
    ASSERT_TRUE(history.step());
    expect_right_incidence(**mesh);
  }
}

// What build() could not make a union of edges is a feature all the same.
TEST(Incidence, OfAnUnresolvedMesh) {
  const Graph graph = inputs::parallels(20, 3, 1000, 60, 1);
  MeshConfig config = inputs::config_for(graph, 1000);
  config.steiner_max = 2;
  OwnedMesh mesh(config);
  ASSERT_EQ(mesh->build(graph.nodes, graph.features), Status::steiner_budget);
  for (std::size_t feature = 0; feature < graph.features.size(); ++feature) {
    const std::vector<FeatureAt> found = found_at(*mesh, graph.features[feature].to, 9);
    EXPECT_EQ(found, (std::vector<FeatureAt>{{FeatureId{static_cast<IdValue>(feature)}, true}}));
  }
}

}  // namespace
}  // namespace etcm::test
