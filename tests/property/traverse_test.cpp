// etcm/traverse.h against what the calls of mesh.h say of each id.
#include "etcm/traverse.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>
#include <vector>

#include "inputs/patterns.h"
#include "support/emulated.h"
#include "support/history.h"
#include "support/meshes.h"

namespace etcm::test {
namespace {

static_assert(std::forward_iterator<MeshRange<internal::NodePlaces>::Iterator>);
static_assert(std::forward_iterator<MeshRange<internal::FeaturePlaces>::Iterator>);
static_assert(std::forward_iterator<MeshRange<internal::EdgePlaces>::Iterator>);

void expect_right_ranges(const Mesh& mesh) {
  std::vector<VertexId> nodes;
  std::set<std::pair<VertexId, VertexId>> edges, constrained;
  for (IdValue id = 1; id < mesh.vertex_id_end(); ++id) {
    const VertexId v{id};
    if (mesh.kind(v) == VertexKind::none) continue;
    if (mesh.kind(v) == VertexKind::node) nodes.push_back(v);
    std::vector<Neighbour> neighbours(mesh.neighbours(v, {}));
    ASSERT_EQ(mesh.neighbours(v, neighbours), neighbours.size());
    for (const Neighbour& other : neighbours) {
      if (other.vertex < v) continue;
      edges.insert({v, other.vertex});
      if (other.constrained) constrained.insert({v, other.vertex});
    }
  }
  EXPECT_TRUE(std::ranges::equal(nodes_of(mesh), nodes));

  std::vector<FeatureId> features;
  for (IdValue id = 0; id < mesh.feature_id_end(); ++id) {
    if (mesh.is_feature(FeatureId{id})) features.push_back(FeatureId{id});
  }
  EXPECT_TRUE(std::ranges::equal(features_of(mesh), features));

  std::size_t count = 0;
  for (const MeshEdge& edge : edges_of(mesh)) {
    ++count;
    EXPECT_EQ(edges.erase({edge.from, edge.to}), 1u) << edge.from.value << "-" << edge.to.value;
    EXPECT_EQ(edge.constrained, constrained.contains({edge.from, edge.to}));
  }
  EXPECT_TRUE(edges.empty()) << count << " edges, " << edges.size() << " left out";
}

TEST(Traverse, GoesOverNone) {
  const auto mesh = empty_mesh();
  EXPECT_EQ(nodes_of(**mesh).begin(), nodes_of(**mesh).end());
  EXPECT_EQ(features_of(**mesh).begin(), features_of(**mesh).end());
  EXPECT_EQ(edges_of(**mesh).begin(), edges_of(**mesh).end());
}

TEST(Traverse, GoesOverOneAndTwo) {
  const auto one = grown({"", {{1, 1}}, {}});
  EXPECT_EQ(std::ranges::distance(nodes_of(**one)), 1);
  EXPECT_EQ(std::ranges::distance(edges_of(**one)), 0);
  const auto two = grown({"", {{1, 1}, {2, 7}}, {between_nodes(1, 0)}});
  EXPECT_EQ(*features_of(**two).begin(), FeatureId{0});
  ASSERT_EQ(std::ranges::distance(edges_of(**two)), 1);
  EXPECT_EQ(*edges_of(**two).begin(), (MeshEdge{vertex_of(0), vertex_of(1), true}));
}

TEST(Traverse, GoesOverALine) {
  const auto mesh = built(inputs::collinear(12, 3));
  EXPECT_EQ(std::ranges::distance(edges_of(**mesh)), 11);
  expect_right_ranges(**mesh);
}

TEST(Traverse, GoesOverAllThatStands) {
  expect_right_ranges(**built(inputs::parallels(20, 3, 1000, 60, 1)));
  expect_right_ranges(**built(inputs::grid(9, 4, inputs::GridFeatures::long_diagonals, 3)));
}

// Ids between others are free, and used again.
TEST(Traverse, LeavesOutWhatHasLeft) {
  const auto mesh = empty_mesh(400, 60);
  History history(**mesh, 20, 40, 29, Course::eventful);
  for (int step = 0; step < (is_slow ? 60 : 600); ++step) {
    ASSERT_TRUE(history.step());
    expect_right_ranges(**mesh);
  }
}

// As containers and algorithms take them.
TEST(Traverse, GivesIterators) {
  const auto mesh = built({"", square, {between_nodes(0, 2)}});
  const auto range = nodes_of(**mesh);
  const std::vector<VertexId> nodes(range.begin(), range.end());
  EXPECT_EQ(nodes.size(), square.size());
  auto each = range.begin();
  EXPECT_EQ(*each++, vertex_of(0));
  EXPECT_EQ(*each, vertex_of(1));
  EXPECT_EQ(std::ranges::count(edges_of(**mesh), true, &MeshEdge::constrained),
            1 + static_cast<std::ptrdiff_t>((*mesh)->steiner_count()));
}

}  // namespace
}  // namespace etcm::test
