// join(), leave(), move(): on a Steiner vertex, on a feature, on the hull, outside, and back.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "etcm/split_site.h"
#include "support/emulated.h"
#include "support/meshes.h"
#include "support/oracle.h"

namespace etcm::test {
namespace {

// As far as a split finishes, but on a whole unit where that is no farther from the head: the
// feature below is 2^10 units long, its grid 2^28 steps.
Parameter on_whole_units(const SplitSite& site) noexcept {
  constexpr Parameter unit = parameter_end / 1024;
  const Parameter whole = site.feasible_head / unit * unit;
  return whole > site.head && whole < site.tail ? whole : split_paper(site);
}

// One long feature with nodes close by on both sides. Steiner vertices are needed, and some of them
// stand on whole units.
class MeshChange : public testing::Test {
 protected:
  MeshChange() : mesh_(empty_mesh(4000, 100, on_whole_units)) {
    Graph graph{"", {{0, 0}, {1024, 0}}, {between_nodes(0, 1)}};
    for (std::int32_t i = 1; i < 16; ++i) graph.nodes.push_back({64 * i, i % 2 == 0 ? 5 : -5});
    EXPECT_EQ(mesh().build(graph.nodes, graph.features), Status::ok);
    EXPECT_GT(mesh().steiner_count(), 0u);
  }

  Mesh& mesh() { return **mesh_; }

  VertexId joined(Position position) {
    VertexId id;
    EXPECT_EQ(mesh().join(position, id), Status::ok) << testing::PrintToString(position);
    EXPECT_TRUE(is_sound(mesh()));
    return id;
  }

  // A Steiner vertex whose place is a whole unit.
  std::optional<VertexId> whole_steiner_vertex() {
    for (const VertexId vertex : steiner_vertices(mesh())) {
      const Point point = mesh().point(vertex);
      if (point.x % subunits_per_unit == 0 && point.y % subunits_per_unit == 0) return vertex;
    }
    return std::nullopt;
  }

  void expect_refused(Status answer, Status expected, const Picture& before) {
    EXPECT_EQ(answer, expected);
    EXPECT_EQ(mesh().error_detail().status, expected);
    EXPECT_EQ(picture_of(mesh()), before);
    EXPECT_TRUE(is_sound(mesh()));
  }

  std::unique_ptr<OwnedMesh> mesh_;
};

TEST_F(MeshChange, JoinsExactlyOnASteinerVertex) {
  const std::optional<VertexId> steiner = whole_steiner_vertex();
  ASSERT_TRUE(steiner) << "the feature has no Steiner vertex on a whole unit";
  const Point point = mesh().point(*steiner);
  const std::uint32_t steiner_before = mesh().steiner_count();
  const VertexId node = joined({static_cast<std::int32_t>(point.x / subunits_per_unit),
                                static_cast<std::int32_t>(point.y / subunits_per_unit)});
  EXPECT_EQ(mesh().kind(node), VertexKind::node);
  EXPECT_EQ(mesh().point(node), point);
  EXPECT_LE(mesh().steiner_count(), steiner_before);
  EXPECT_EQ(mesh().leave(node), Status::ok);
  EXPECT_TRUE(is_sound(mesh()));
  EXPECT_EQ(mesh().feature_count(), 1u);
}

TEST_F(MeshChange, JoinsOnAFeatureAndLeavesIt) {
  const VertexId node = joined({333, 0});
  std::vector<VertexId> chain(mesh().chain(FeatureId{0}, {}));
  chain.resize(mesh().chain(FeatureId{0}, chain));
  EXPECT_EQ(std::count(chain.begin(), chain.end(), node), 1);
  EXPECT_EQ(mesh().leave(node), Status::ok);
  EXPECT_TRUE(is_sound(mesh()));
}

TEST_F(MeshChange, JoinsOnTheHullAndOutsideAndLeavesIt) {
  const std::uint64_t before = mesh().hash();
  for (const Position position : {Position{512, 900}, Position{-700, 3}, Position{2000, 0},
                                  Position{position_max, -position_max}}) {
    const VertexId node = joined(position);
    EXPECT_EQ(mesh().leave(node), Status::ok);
    EXPECT_TRUE(is_sound(mesh()));
  }
  EXPECT_EQ(mesh().rebuild(), Status::ok);
  EXPECT_EQ(mesh().hash(), before);
}

TEST_F(MeshChange, RefusesToJoinWhereANodeStands) {
  const Picture before = picture_of(mesh());
  VertexId id;
  expect_refused(mesh().join({64, -5}, id), Status::duplicate_vertex, before);
  EXPECT_EQ(mesh().error_detail().vertex, vertex_of(2));
  EXPECT_TRUE(id.is_none());
}

// The room of a feature through four nodes, and no more.
TEST(TightRoom, LetsANodeMoveAlongItsFeature) {
  const Graph graph{
      "", {{0, 0}, {300, 0}, {600, 0}, {900, 0}, {450, 7}, {450, -7}}, {between_nodes(0, 3)}};
  OwnedMesh mesh({.vertices_max = 60, .features_max = 3});
  ASSERT_EQ(mesh.opened(), Status::ok);
  ASSERT_EQ(mesh->build(graph.nodes, graph.features), Status::ok);
  for (const std::int32_t x : {400, 700, 500, 100, 301}) {
    ASSERT_EQ(mesh->move(vertex_of(1), {x, 0}), Status::ok) << x;
    ASSERT_TRUE(is_sound(*mesh));
    Graph moved = graph;
    moved.nodes[1].x = x;
    ASSERT_EQ(mesh->canonicalize(), Status::ok);
    EXPECT_EQ(mesh->hash(), (*built(moved))->hash());
  }
  EXPECT_EQ(mesh->feature_id_end(), 3u);
}

// From one feature to another: its place goes with it.
TEST(TightRoom, LetsANodeMoveToAnotherFeature) {
  const Graph graph{"",
                    {{0, 0}, {900, 0}, {0, 50}, {900, 50}, {300, 0}, {450, 25}},
                    {between_nodes(0, 1), between_nodes(2, 3)}};
  OwnedMesh mesh({.vertices_max = 200, .features_max = 3});
  ASSERT_EQ(mesh.opened(), Status::ok);
  ASSERT_EQ(mesh->build(graph.nodes, graph.features), Status::ok);
  ASSERT_EQ(mesh->move(vertex_of(4), {400, 50}), Status::ok);
  EXPECT_TRUE(is_sound(*mesh));
  ASSERT_EQ(mesh->move(vertex_of(4), {500, 0}), Status::ok);
  EXPECT_TRUE(is_sound(*mesh));
}

// The move finds a place on a feature, and none for the Steiner vertices that it then takes.
TEST(TightRoom, TakesARefusedMoveAlongAFeatureBack) {
  std::mt19937 random(1);
  const auto below = [&random](std::uint32_t n) { return static_cast<std::int32_t>(random() % n); };
  constexpr int rounds = 400 / thinning_if_slow;
  int refused = 0;
  for (int round = 0; round < rounds; ++round) {
    std::vector<Position> nodes{{0, 0}, {900, 0}, {0, 50}, {900, 50}, {10 + below(880), 0}};
    for (int i = 0; i < 8; ++i) nodes.push_back({below(900), 50 * below(2) - 1 + 2 * below(2)});
    const std::array features{between_nodes(0, 1), between_nodes(2, 3)};
    // What build() takes, and not a place more.
    std::unique_ptr<OwnedMesh> made;
    Status status = Status::out_of_vertices;
    for (std::uint32_t room = 13; status == Status::out_of_vertices; ++room) {
      made = empty_mesh(room, 3);
      status = (*made)->build(nodes, features);
    }
    if (status != Status::ok) continue;
    OwnedMesh& mesh = *made;
    const Picture before = picture_of(*mesh);
    if (mesh->move(vertex_of(4), {1 + below(898), 50 * below(2)}) == Status::ok) continue;
    EXPECT_EQ(mesh->error_detail().status, Status::out_of_vertices);
    ++refused;
    ASSERT_EQ(picture_of(*mesh), before);
    EXPECT_TRUE(mesh->is_canonical());
    ASSERT_TRUE(is_sound(*mesh));
    for (IdValue id = 0; id < 2; ++id) {
      EXPECT_EQ(mesh->remove_feature(FeatureId{id}), Status::ok);
    }
    EXPECT_EQ(mesh->leave(vertex_of(4)), Status::ok);
    ASSERT_TRUE(is_sound(*mesh));
  }
  EXPECT_GT(refused, rounds / 8);
}

// What is canonical needs no room to be made so.
TEST(TightRoom, SufficesToRebuildWhatIsBuilt) {
  const Graph graph{
      "", {{0, 0}, {1000, 10}, {480, 90}, {520, -60}, {500, 900}}, {between_nodes(0, 1)}};
  const std::uint32_t needed = (*built(graph))->steiner_count() + 5;
  ASSERT_GT(needed, 5u);
  OwnedMesh mesh({.vertices_max = needed, .features_max = 1});
  ASSERT_EQ(mesh.opened(), Status::ok);
  ASSERT_EQ(mesh->build(graph.nodes, graph.features), Status::ok);
  const Picture before = picture_of(*mesh);
  EXPECT_EQ(mesh->canonicalize(), Status::ok);
  EXPECT_EQ(mesh->rebuild(), Status::ok);
  EXPECT_EQ(picture_of(*mesh), before);
}

// Refused calls of every kind, in a mesh with ids that are free and in one without.
TEST(Refusals, LeaveTheIdsInUseAsTheyWere) {
  for (const bool has_free_ids : {false, true}) {
    OwnedMesh mesh({.vertices_max = 60, .features_max = 6, .steiner_max = 3});
    ASSERT_EQ(mesh.opened(), Status::ok);
    const std::array nodes{Position{0, 0},     Position{1000, 10}, Position{480, 90},
                           Position{520, -60}, Position{500, 900}, Position{3, 800}};
    const std::array features{between_nodes(0, 1)};
    ASSERT_EQ(mesh->build(nodes, features), Status::ok);
    if (has_free_ids) {
      ASSERT_EQ(mesh->leave(vertex_of(5)), Status::ok);
    }
    ASSERT_GT(mesh->steiner_count(), 0u);
    const IdValue vertices = mesh->vertex_id_end(), segments = mesh->feature_id_end();
    const bool was_canonical = mesh->is_canonical();
    int refused = 0;
    const auto expect_same_ids = [&](Status answer) {
      refused += answer != Status::ok ? 1 : 0;
      EXPECT_EQ(mesh->vertex_id_end(), vertices) << to_string(answer);
      EXPECT_EQ(mesh->feature_id_end(), segments) << to_string(answer);
      EXPECT_EQ(mesh->is_canonical(), was_canonical) << to_string(answer);
      EXPECT_TRUE(is_sound(*mesh));
    };
    VertexId id;
    FeatureId feature;
    expect_same_ids(mesh->join({480, 90}, id));
    expect_same_ids(mesh->join({position_max + 1, 90}, id));
    expect_same_ids(mesh->add_feature({vertex_of(0), vertex_of(1)}, feature));
    expect_same_ids(mesh->add_feature({vertex_of(2), vertex_of(3)}, feature));
    expect_same_ids(mesh->move(vertex_of(4), {480, 90}));
    expect_same_ids(mesh->move(vertex_of(4), {position_max + 1, 90}));
    const int by_the_input = refused;
    EXPECT_EQ(by_the_input, 6);
    // Beside the feature, until it takes too many Steiner vertices.
    for (std::int32_t x = 100; x < 1000 && refused == by_the_input; x += 50) {
      const std::uint64_t hash = mesh->hash();
      const IdValue end = mesh->vertex_id_end();
      if (mesh->join({x, x % 100 == 0 ? x / 100 + 1 : x / 100 - 1}, id) == Status::ok) continue;
      ++refused;
      EXPECT_EQ(mesh->vertex_id_end(), end);
      EXPECT_EQ(mesh->hash(), hash);
      EXPECT_EQ(mesh->move(vertex_of(4), {x, x % 100 == 0 ? x / 100 + 1 : x / 100 - 1}),
                Status::steiner_budget);
      EXPECT_EQ(mesh->vertex_id_end(), end);
      EXPECT_EQ(mesh->hash(), hash);
      EXPECT_TRUE(is_sound(*mesh));
    }
    EXPECT_GT(refused, by_the_input);
  }
}

TEST_F(MeshChange, RefusesToJoinOutOfRange) {
  const Picture before = picture_of(mesh());
  VertexId id;
  for (const std::int32_t bad :
       {position_max + 1, -position_max - 1, std::numeric_limits<std::int32_t>::min(),
        std::numeric_limits<std::int32_t>::max()}) {
    expect_refused(mesh().join({bad, 0}, id), Status::bad_coordinate, before);
    expect_refused(mesh().join({0, bad}, id), Status::bad_coordinate, before);
    expect_refused(mesh().move(vertex_of(2), {bad, bad}), Status::bad_coordinate, before);
  }
}

TEST_F(MeshChange, RefusesWhatIsNoNode) {
  const Picture before = picture_of(mesh());
  for (const VertexId unknown : {infinite_vertex, VertexId::none(), VertexId{3999}, VertexId{9999},
                                 steiner_vertices(mesh()).front()}) {
    expect_refused(mesh().leave(unknown), Status::unknown_vertex, before);
    expect_refused(mesh().move(unknown, {1, 1}), Status::unknown_vertex, before);
    FeatureId id;
    expect_refused(mesh().add_feature({unknown, vertex_of(1)}, id), Status::unknown_vertex, before);
  }
  for (const FeatureId unknown : {FeatureId::none(), FeatureId{1}, FeatureId{9999}}) {
    expect_refused(mesh().remove_feature(unknown), Status::unknown_feature, before);
  }
}

TEST_F(MeshChange, RefusesToLetAnEndpointLeave) {
  const Picture before = picture_of(mesh());
  expect_refused(mesh().leave(vertex_of(0)), Status::endpoint_in_use, before);
  ASSERT_EQ(mesh().remove_feature(FeatureId{0}), Status::ok);
  EXPECT_EQ(mesh().steiner_count(), 0u);
  EXPECT_EQ(mesh().leave(vertex_of(0)), Status::ok);
  EXPECT_TRUE(is_sound(mesh()));
}

TEST_F(MeshChange, MovesANodeAcrossAFeature) {
  EXPECT_EQ(mesh().move(vertex_of(8), {450, 40}), Status::ok);
  EXPECT_TRUE(is_sound(mesh()));
  EXPECT_EQ(mesh().move(vertex_of(8), {450, 0}), Status::ok) << "onto it";
  EXPECT_TRUE(is_sound(mesh()));
  EXPECT_EQ(mesh().move(vertex_of(8), {450, -40}), Status::ok) << "off it again";
  EXPECT_TRUE(is_sound(mesh()));
  EXPECT_EQ(mesh().position(vertex_of(8)), (Position{450, -40}));
}

TEST_F(MeshChange, MovesToWhereItStands) {
  const std::uint64_t before = mesh().hash();
  EXPECT_EQ(mesh().move(vertex_of(3), mesh().position(vertex_of(3))), Status::ok);
  EXPECT_EQ(mesh().hash(), before);
}

TEST_F(MeshChange, MovesAnEndAndItsFeatureFollows) {
  EXPECT_EQ(mesh().move(vertex_of(1), {900, 300}), Status::ok);
  EXPECT_TRUE(is_sound(mesh()));
  EXPECT_EQ(mesh().ends(FeatureId{0}).to, vertex_of(1));
}

TEST_F(MeshChange, RefusesAMoveThatMakesFeaturesCross) {
  const VertexId low = joined({100, -500});
  const VertexId lower = joined({200, -500});
  FeatureId id;
  ASSERT_EQ(mesh().add_feature({low, lower}, id), Status::ok);
  const Picture before = picture_of(mesh());
  expect_refused(mesh().move(lower, {300, 500}), Status::crossing_features, before);
  expect_refused(mesh().move(low, {64, -5}), Status::duplicate_vertex, before);
  expect_refused(mesh().move(vertex_of(0), {150, -510}), Status::crossing_features, before);
  EXPECT_EQ(mesh().move(vertex_of(0), {150, -500}), Status::ok) << "features may meet at a node";
  EXPECT_TRUE(is_sound(mesh()));
}

TEST_F(MeshChange, RefusesALeaveThatMakesFeaturesCross) {
  const VertexId node = joined({512, 0});
  const VertexId above = joined({512, 100});
  const VertexId below = joined({512, -100});
  FeatureId id;
  ASSERT_EQ(mesh().add_feature({above, below}, id), Status::ok);
  const Picture before = picture_of(mesh());
  expect_refused(mesh().leave(node), Status::crossing_features, before);
  expect_refused(mesh().move(node, {511, 1}), Status::crossing_features, before);
}

TEST_F(MeshChange, RefusesFeaturesThatMayNotLie) {
  const Picture before = picture_of(mesh());
  FeatureId id;
  const auto refused = [&](std::size_t from, std::size_t to, Status expected) {
    expect_refused(mesh().add_feature(between_nodes(from, to), id), expected, before);
    expect_refused(mesh().add_feature(between_nodes(to, from), id), expected, before);
    EXPECT_TRUE(id.is_none());
  };
  refused(4, 4, Status::zero_length_feature);
  refused(0, 1, Status::repeated_feature);
  refused(2, 3, Status::crossing_features);
}

TEST_F(MeshChange, RefusesFeaturesThatOverlap) {
  const VertexId on = joined({400, 0});
  const VertexId beyond = joined({1500, 0});
  const Picture before = picture_of(mesh());
  FeatureId id;
  expect_refused(mesh().add_feature({vertex_of(0), on}, id), Status::overlapping_features, before);
  expect_refused(mesh().add_feature({beyond, on}, id), Status::overlapping_features, before);
  EXPECT_EQ(mesh().add_feature({beyond, vertex_of(1)}, id), Status::ok) << "end to end is legal";
  EXPECT_TRUE(is_sound(mesh()));
}

TEST_F(MeshChange, TakesOutSteinerVerticesWhoseCauseHasGone) {
  for (std::size_t node = 2; node < 17; ++node)
    ASSERT_EQ(mesh().leave(vertex_of(node)), Status::ok);
  EXPECT_EQ(mesh().steiner_count(), 0u);
  EXPECT_EQ(mesh().node_count(), 2u);
  EXPECT_TRUE(is_sound(mesh()));
}

TEST_F(MeshChange, ShrinksToNothingAndGrowsAgain) {
  ASSERT_EQ(mesh().remove_feature(FeatureId{0}), Status::ok);
  for (std::size_t node = 0; node < 17; ++node) {
    ASSERT_EQ(mesh().leave(vertex_of(node)), Status::ok);
    ASSERT_TRUE(is_sound(mesh()));
  }
  EXPECT_EQ(mesh().hash(), (*empty_mesh())->hash());
  joined({1, 1});
  joined({2, 2});
  joined({0, 5});
  EXPECT_EQ(mesh().finite_triangle_count(), 1u);
}

// build() that gives up for want of steps leaves a mesh of which each later answer is true.
bool has_an_other(Status status) {
  return status == Status::crossing_features || status == Status::overlapping_features ||
         status == Status::repeated_feature;
}

// Places so few that nearly everything meets something.
TEST(Refusals, NameBothFeatures) {
  std::mt19937 random(1);
  const auto below = [&random](std::uint32_t n) { return static_cast<std::int32_t>(random() % n); };
  const auto place = [&] { return Position{below(5), below(4)}; };
  std::map<Status, int> refused;
  for (int round = 0; round < 3000; ++round) {
    const auto mesh = empty_mesh(200, 60);
    std::vector<Position> nodes;
    for (std::int32_t i = 0; i < 20; ++i) {
      if (below(3) != 0) nodes.push_back({i % 5, i / 5});
    }
    std::vector<FeatureEnds> features;
    const auto any_node = [&] { return vertex_of(random() % nodes.size()); };
    for (std::int32_t i = below(4); i > 0; --i) features.push_back({any_node(), any_node()});
    Status status = (*mesh)->build(nodes, features);
    if (status != Status::ok) {
      if (!has_an_other(status)) continue;
      ++refused[status];
      const ErrorDetail& detail = (*mesh)->error_detail();
      EXPECT_NE(detail.feature, detail.other);
      EXPECT_LT(std::max(detail.feature, detail.other).value, features.size());
      continue;
    }
    for (int change = 0; change < 12; ++change) {
      FeatureId id;
      const bool adds = below(3) == 0;
      if (adds) {
        status = (*mesh)->add_feature({any_node(), any_node()}, id);
      } else if (below(2) == 0) {
        status = (*mesh)->leave(any_node());
      } else {
        status = (*mesh)->move(any_node(), place());
      }
      if (!has_an_other(status)) continue;
      ++refused[status];
      const ErrorDetail& detail = (*mesh)->error_detail();
      EXPECT_TRUE((*mesh)->is_feature(detail.other)) << to_string(status);
      EXPECT_EQ((*mesh)->is_feature(detail.feature), !adds) << to_string(status);
      EXPECT_NE(detail.feature, detail.other);
    }
  }
  EXPECT_EQ(refused.size(), 3u);
}

// Which would have to be split where the new one has broken it.
TEST(Refusals, OfAFeatureNameTheOneThatItBreaks) {
  MeshConfig config{.vertices_max = 60, .features_max = 10, .steiner_max = 2};
  OwnedMesh mesh(config);
  ASSERT_EQ(mesh.opened(), Status::ok);
  VertexId node;
  for (const Position position : {Position{6, 9}, {9, 4}, {4, 7}, {6, 8}, {7, 2}}) {
    ASSERT_EQ(mesh->join(position, node), Status::ok);
  }
  FeatureId first, second;
  ASSERT_EQ(mesh->add_feature({vertex_of(4), vertex_of(0)}, first), Status::ok);
  ASSERT_EQ(mesh->add_feature({vertex_of(4), vertex_of(3)}, second), Status::steiner_budget);
  const ErrorDetail& detail = mesh->error_detail();
  EXPECT_EQ(detail.feature, first);
  EXPECT_EQ(detail.to, mesh->point(vertex_of(4)));
}

TEST(Refusals, NeedWhatTheyHaveUsed) {
  const auto mesh = empty_mesh(3, 1);
  VertexId node;
  for (const Position position : {Position{0, 0}, {5, 1}, {2, 7}}) {
    ASSERT_EQ((*mesh)->join(position, node), Status::ok);
  }
  EXPECT_GT((*mesh)->work_needed().units, (*mesh)->work_used().units);
  FeatureId feature;
  ASSERT_EQ((*mesh)->add_feature({vertex_of(0), vertex_of(1)}, feature), Status::ok);
  ASSERT_EQ((*mesh)->add_feature({vertex_of(0), vertex_of(2)}, feature), Status::out_of_features);
  EXPECT_EQ((*mesh)->work_needed().units, (*mesh)->work_used().units);
  ASSERT_EQ((*mesh)->join({9, 9}, node), Status::out_of_vertices);
  EXPECT_EQ((*mesh)->work_needed().units, (*mesh)->work_used().units);
}

TEST(AfterAnIncompleteBuild, ARefusedMoveChangesNothing) {
  MeshConfig config{.vertices_max = 100, .features_max = 20, .steiner_max = 1};
  OwnedMesh mesh(config);
  ASSERT_EQ(mesh.opened(), Status::ok);
  const std::vector<Position> nodes{{3, 3}, {2, 2}, {2, 3}, {1, 0}, {1, 3},
                                    {3, 2}, {1, 2}, {2, 1}, {0, 0}, {3, 0}};
  const std::vector<FeatureEnds> features{between_nodes(1, 2), between_nodes(0, 8),
                                          between_nodes(3, 7), between_nodes(0, 9)};
  const Status answer = mesh->build(nodes, features);
  EXPECT_EQ(mesh->unresolved() == 0, answer == Status::ok);
  EXPECT_TRUE(is_sound(*mesh));
  const Picture before = picture_of(*mesh);
  EXPECT_NE(mesh->move(vertex_of(0), {-1, 0}), Status::ok);
  EXPECT_EQ(picture_of(*mesh), before);
  EXPECT_TRUE(is_sound(*mesh));
}

}  // namespace
}  // namespace etcm::test
