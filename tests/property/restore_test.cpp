// Mesh::restore(): the mesh of another mesh's nodes, features and Steiner vertices is that mesh,
// whatever its life was; anything else is refused and leaves nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <vector>

#include "inputs/random.h"
#include "support/history.h"
#include "support/meshes.h"
#include "support/oracle.h"

namespace etcm::test {
namespace {

struct Kept {
  std::vector<Position> nodes;
  std::vector<FeatureEnds> features;
  std::vector<SteinerPlace> steiner;

  Status restore(Mesh& mesh) const { return mesh.restore(nodes, features, steiner); }
};

Kept kept_of(const Mesh& mesh) {
  Kept kept;
  std::map<VertexId, VertexId> places;
  for (IdValue id = 1; id < mesh.vertex_id_end(); ++id) {
    if (mesh.kind(VertexId{id}) != VertexKind::node) continue;
    places[VertexId{id}] = vertex_of(kept.nodes.size());
    kept.nodes.push_back(mesh.position(VertexId{id}));
  }
  std::map<FeatureId, std::uint32_t> numbers;
  for (IdValue id = 0; id < mesh.feature_id_end(); ++id) {
    if (!mesh.is_feature(FeatureId{id})) continue;
    const FeatureEnds ends = mesh.ends(FeatureId{id});
    numbers[FeatureId{id}] = static_cast<std::uint32_t>(kept.features.size());
    kept.features.push_back({places.at(ends.from), places.at(ends.to)});
  }
  for (const VertexId v : steiner_vertices(mesh)) {
    kept.steiner.push_back({numbers.at(mesh.feature_of(v)), mesh.point(v)});
  }
  return kept;
}

// As long as a mesh lives, what it is can be had again, and lives on.
void expect_restorable(std::int32_t side, std::size_t crowd, int events) {
  const MeshConfig config{.vertices_max = 400, .features_max = 200};
  std::size_t with_steiner = 0;
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    OwnedMesh mesh(config);
    ASSERT_EQ(mesh.opened(), Status::ok);
    History history(*mesh, side, crowd, seed);
    for (int event = 1; event <= events; ++event) {
      ASSERT_TRUE(history.step());
      if (event % 50 != 0) continue;
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", event " << event);
      const Kept kept = kept_of(*mesh);
      with_steiner += kept.steiner.empty() ? 0 : 1;
      OwnedMesh again(config);
      ASSERT_EQ(again.opened(), Status::ok);
      ASSERT_EQ(kept.restore(*again), Status::ok);
      ASSERT_EQ(again->hash(), mesh->hash());
      ASSERT_EQ(again->feature_count(), mesh->feature_count());
      ASSERT_TRUE(passes_audit(*again));
      if (event % 500 != 0) continue;
      ASSERT_TRUE(passes_oracle(*again));
      for (IdValue id = again->feature_id_end(); id-- > 0;) {
        if (again->is_feature(FeatureId{id})) {
          ASSERT_EQ(again->remove_feature(FeatureId{id}), Status::ok);
        }
      }
      ASSERT_EQ(again->steiner_count(), 0u);
      for (IdValue id = 1; id <= kept.nodes.size(); ++id) {
        ASSERT_EQ(again->leave(VertexId{id}), Status::ok);
      }
      ASSERT_TRUE(passes_audit(*again));
    }
  }
  EXPECT_GT(with_steiner, 0u);
}

TEST(Restore, GivesTheMeshOfACrowdedLifeAgain) { expect_restorable(12, 40, 1000); }
TEST(Restore, GivesTheMeshOfAWideLifeAgain) { expect_restorable(1000, 60, 1000); }
TEST(Restore, GivesTheMeshAtTheEdgeOfTheRangeAgain) { expect_restorable(position_max, 60, 500); }

TEST(Restore, OfNothingIsTheEmptyMesh) {
  const auto mesh = empty_mesh();
  EXPECT_EQ((*mesh)->restore({}, {}, {}), Status::ok);
  EXPECT_EQ((*mesh)->hash(), (*empty_mesh())->hash());
}

// One feature through many nodes, with Steiner vertices between all of them.
Graph beset_line(std::int32_t nodes) {
  Graph graph{"", {}, {between_nodes(0, static_cast<std::size_t>(nodes - 1))}};
  for (std::int32_t i = 0; i < nodes; ++i) graph.nodes.push_back({100 * i, 10 * i});
  for (std::int32_t i = 1; i < nodes; ++i) {
    graph.nodes.push_back({100 * i - 50, 10 * i - 1});
    graph.nodes.push_back({100 * i - 49, 10 * i - 9});
  }
  return graph;
}

TEST(Restore, TakesSteinerVerticesInAnyOrder) {
  const auto mesh = built(beset_line(50));
  Kept kept = kept_of(**mesh);
  ASSERT_GT(kept.steiner.size(), 40u);
  inputs::Random random(1);
  for (int turn = 0; turn < 5; ++turn) {
    inputs::shuffle(kept.steiner, random);
    const auto again = empty_mesh();
    ASSERT_EQ(kept.restore(**again), Status::ok);
    EXPECT_EQ((*again)->hash(), (*mesh)->hash());
    EXPECT_TRUE(passes_audit(**again));
  }
}

TEST(Restore, TakesNoSteinerVertexOnTheLineThatIsNoneOfIt) {
  const Kept kept = kept_of(**built(beset_line(5)));
  constexpr std::int64_t unit = subunits_per_unit;
  // On a node, between places of the grid, before the first node, beyond the last.
  for (const Point wrong :
       {Point{200 * unit, 20 * unit}, Point{0, 0}, Point{250 * unit + 5, 0},
        Point{-10 * unit, -unit}, Point{410 * unit, 41 * unit}, Point{400 * unit, 40 * unit}}) {
    Kept other = kept;
    other.steiner.push_back({0, wrong});
    const auto mesh = empty_mesh();
    EXPECT_EQ(other.restore(**mesh), Status::bad_coordinate);
    EXPECT_EQ((*mesh)->node_count() + (*mesh)->steiner_count(), 0u);
    EXPECT_EQ(kept.restore(**mesh), Status::ok);
  }
}

class RestoreRefuses : public testing::Test {
 protected:
  RestoreRefuses() {
    // A fence with posts close by on both sides needs Steiner vertices.
    const Graph graph{"", {{0, 0}, {1000, 10}, {480, 90}, {520, -60}}, {between_nodes(0, 1)}};
    kept_ = kept_of(**built(graph));
  }
  void expect(Status status, const Kept& kept,
              MeshConfig config = {.vertices_max = 50, .features_max = 10}) {
    OwnedMesh mesh(config);
    ASSERT_EQ(mesh.opened(), Status::ok);
    EXPECT_EQ(kept.restore(*mesh), status);
    const ErrorDetail& detail = mesh->error_detail();
    EXPECT_EQ(detail.status, status);
    if (status == Status::crossing_features || status == Status::overlapping_features ||
        status == Status::repeated_feature) {
      EXPECT_EQ(std::min(detail.feature, detail.other), FeatureId{0});
      EXPECT_EQ(std::max(detail.feature, detail.other), FeatureId{1});
    }
    EXPECT_EQ(mesh->node_count() + mesh->steiner_count() + mesh->feature_count(), 0u);
    EXPECT_TRUE(passes_audit(*mesh));
    EXPECT_EQ(kept_.restore(*mesh), Status::ok) << "an empty mesh is as good as a new one";
  }
  Kept kept_;
};

TEST_F(RestoreRefuses, WhatIsNoUnionOfEdges) {
  ASSERT_GT(kept_.steiner.size(), 0u);
  Kept kept = kept_;
  kept.steiner.pop_back();
  expect(Status::mesh_unresolved, kept);
}

TEST_F(RestoreRefuses, SteinerVerticesBesideTheirFeature) {
  const Point at = kept_.steiner.front().point;
  constexpr std::int64_t far = std::int64_t{1} << 62;
  for (const Point wrong : {Point{at.x, at.y + 1}, Point{at.x + 1, at.y}, Point{-far, far},
                            Point{far, -far}, Point{0, 1}, Point{at.x, -far}}) {
    Kept kept = kept_;
    kept.steiner.front().point = wrong;
    expect(Status::bad_coordinate, kept);
  }
}

TEST_F(RestoreRefuses, TwoSteinerVerticesOnOnePlace) {
  Kept kept = kept_;
  kept.steiner.push_back(kept.steiner.front());
  expect(Status::duplicate_vertex, kept);
}

TEST_F(RestoreRefuses, SteinerVerticesOfNoFeature) {
  for (const std::uint32_t number : {1u, 9u, 0xffffffffu}) {
    Kept kept = kept_;
    kept.steiner.front().feature = number;
    expect(Status::unknown_feature, kept);
  }
}

TEST_F(RestoreRefuses, FeaturesThatCross) {
  Kept kept = kept_;
  kept.features.push_back({vertex_of(2), vertex_of(3)});
  expect(Status::crossing_features, kept);
}

TEST_F(RestoreRefuses, AFeatureTwice) {
  Kept kept = kept_;
  kept.features.push_back({vertex_of(1), vertex_of(0)});
  expect(Status::repeated_feature, kept);
  // With Steiner vertices of their own, as well.
  kept.steiner.insert(kept.steiner.end(), kept_.steiner.begin(), kept_.steiner.end());
  for (std::size_t i = kept_.steiner.size(); i < kept.steiner.size(); ++i) {
    kept.steiner[i].feature = 1;
  }
  expect(Status::repeated_feature, kept);
}

TEST_F(RestoreRefuses, FeaturesAlongEachOther) {
  Kept kept;
  kept.nodes = {{0, 0}, {10, 0}, {20, 0}, {30, 0}};
  kept.features = {{vertex_of(0), vertex_of(2)}, {vertex_of(3), vertex_of(1)}};
  expect(Status::overlapping_features, kept);
}

TEST_F(RestoreRefuses, MoreThanThereIsRoomFor) {
  Kept kept;
  kept.nodes = {{0, 0}, {16, 0}};
  kept.features = {{vertex_of(0), vertex_of(1)}};
  for (std::int64_t i = 1; i <= 8; ++i) {
    kept.steiner.push_back({0, {i * subunits_per_unit, 0}});
  }
  OwnedMesh mesh({.vertices_max = 9, .features_max = 1});
  ASSERT_EQ(mesh.opened(), Status::ok);
  EXPECT_EQ(kept.restore(*mesh), Status::out_of_vertices);
  OwnedMesh budget({.vertices_max = 50, .features_max = 1, .steiner_max = 7});
  ASSERT_EQ(budget.opened(), Status::ok);
  EXPECT_EQ(kept.restore(*budget), Status::steiner_budget);
  kept.steiner.pop_back();
  EXPECT_EQ(kept.restore(*budget), Status::ok);
}

}  // namespace
}  // namespace etcm::test
