// Whatever has happened to a mesh, it can be made the one that build() makes of what stands.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <vector>

#include "etcm/split_site.h"
#include "inputs/random.h"
#include "inputs/random_graph.h"
#include "support/canonical_life.h"
#include "support/emulated.h"
#include "support/meshes.h"

namespace etcm::test {
namespace {

std::uint64_t hash_of_build(const Mesh& mesh) {
  return (*built(graph_of(mesh), mesh.config().policy))->hash();
}

TEST(Canonical, IsWhatBuildMakesAfterAnyChange) {
  std::uint64_t compared = 0;
  for (std::uint64_t seed = 1; seed <= (is_slow ? 6u : 60u); ++seed) {
    CanonicalLife life(seed);
    ASSERT_TRUE(life.live(60)) << "seed " << seed << ", " << life.name();
    compared += life.compared();
  }
  EXPECT_GT(compared, is_slow ? 100u : 1000u);
}

// Where many features meet, not each that begins or ends there is looked at for one that comes or
// goes, but those that its far end has an influence on.
TEST(Canonical, IsWhatBuildMakesWhereFeaturesComeAndGoAtANodeOfMany) {
  constexpr std::int32_t side = 1000;
  // The first two show what it would be to look at none of them, or at half.
  std::vector<std::uint64_t> seeds{106, 835};
  for (std::uint64_t seed = 1; seed <= (is_slow ? 4u : 40u); ++seed) seeds.push_back(seed);
  for (const std::uint64_t seed : seeds) {
    inputs::Random random(seed);
    const auto spokes = static_cast<std::size_t>(10 + seed % 20);
    const auto others = static_cast<std::size_t>(seed % 37);
    // The one that all end at, or that all begin at.
    const std::int32_t x = seed % 2 == 0 ? -side : 2 * side;
    Graph graph{"hub", {{x, side / 2}}, {}};
    while (graph.nodes.size() < 1 + spokes + others) {
      graph.nodes.push_back({random.between(0, side), random.between(0, side)});
    }
    const auto mesh = grown({graph.name, graph.nodes, {}});
    std::vector<FeatureId> features;
    for (std::size_t i = 1; i <= spokes; ++i) {
      FeatureId feature;
      const Status status = (*mesh)->add_feature({vertex_of(0), vertex_of(i)}, feature);
      if (status == Status::ok) features.push_back(feature);
    }
    ASSERT_FALSE(features.empty());
    ASSERT_EQ((*mesh)->canonicalize(), Status::ok);
    ASSERT_EQ((*mesh)->hash(), hash_of_build(**mesh)) << "seed " << seed;
    for (const FeatureId feature : features) {
      const FeatureEnds ends = (*mesh)->ends(feature);
      ASSERT_EQ((*mesh)->remove_feature(feature), Status::ok);
      ASSERT_EQ((*mesh)->canonicalize(), Status::ok);
      ASSERT_EQ((*mesh)->hash(), hash_of_build(**mesh)) << "seed " << seed << ", removed";
      FeatureId again;
      ASSERT_EQ((*mesh)->add_feature(ends, again), Status::ok);
      ASSERT_EQ((*mesh)->canonicalize(), Status::ok);
      ASSERT_EQ((*mesh)->hash(), hash_of_build(**mesh)) << "seed " << seed << ", added";
    }
  }
}

TEST(Canonical, ForgetsAThousandMovesOfOneNode) {
  const Graph graph = inputs::random_graph(200, inputs::FeatureLength::any, 5);
  const auto mesh = built(graph);
  const std::uint64_t before = (*mesh)->hash();
  const std::uint32_t steiner = (*mesh)->steiner_count();
  VertexId wanderer;
  ASSERT_EQ((*mesh)->join({-40, -40}, wanderer), Status::ok);
  inputs::Random random(1);
  for (int i = 0; i < (is_slow ? 100 : 1000); ++i) {
    static_cast<void>((*mesh)->move(wanderer, {random.between(0, 1000), random.between(0, 1000)}));
  }
  ASSERT_EQ((*mesh)->leave(wanderer), Status::ok);
  EXPECT_GT((*mesh)->steiner_count(), steiner) << "the moves have left nothing to forget";
  EXPECT_FALSE((*mesh)->is_canonical());
  ASSERT_EQ((*mesh)->canonicalize(), Status::ok);
  EXPECT_EQ((*mesh)->hash(), before);
  EXPECT_TRUE((*mesh)->is_canonical());
}

TEST(Canonical, IsAMeshFreshlyBuiltAndOneWithoutFeatures) {
  const auto mesh = built(inputs::random_graph(60, inputs::FeatureLength::any, 5));
  EXPECT_TRUE((*mesh)->is_canonical());
  const std::uint64_t before = (*mesh)->hash();
  EXPECT_EQ((*mesh)->canonicalize(), Status::ok);
  EXPECT_EQ((*mesh)->hash(), before);

  const auto plain = grown({"", square, {}});
  EXPECT_TRUE((*plain)->is_canonical());
  EXPECT_EQ((*plain)->canonicalize(), Status::ok);
  EXPECT_TRUE((*empty_mesh())->is_canonical());
}

TEST(Canonical, TakesNothingBackWhereAJoinTouchesNoFeature) {
  const auto mesh = built(inputs::random_graph(300, inputs::FeatureLength::in_reach, 5));
  const std::uint32_t steiner = (*mesh)->steiner_count();
  VertexId far_away;
  ASSERT_EQ((*mesh)->join({3'000'000, 3'000'000}, far_away), Status::ok);
  EXPECT_EQ((*mesh)->canonicalize(), Status::ok);
  EXPECT_EQ((*mesh)->steiner_count(), steiner);
  EXPECT_EQ((*mesh)->hash(), hash_of_build(**mesh));
}

// Where build() takes out a Steiner vertex beside a needle of a triangle, what it had an influence
// on must be known: else each segment may depend on any other, and all are laid again for ever.
TEST(Canonical, LaysFewAgainWhereANeedleHasStood) {
  const Position nodes[] = {{77, 42}, {13, 79}, {42, 36}, {77, 21}, {57, 34}, {41, 66}, {42, 48},
                            {36, 55}, {50, 26}, {48, 22}, {54, 78}, {57, 30}, {24, 14}, {33, 24},
                            {45, 71}, {41, 18}, {12, 9},  {26, 11}, {28, 40}, {38, 65}, {70, 71},
                            {59, 34}, {41, 76}, {40, 48}, {59, 73}, {8, 49},  {23, 26}, {1, 5},
                            {39, 41}, {23, 20}, {35, 28}, {41, 27}, {79, 50}, {54, 55}, {6, 49},
                            {17, 12}, {64, 65}};
  constexpr std::size_t features[][2] = {{13, 5}, {30, 2}, {30, 10}, {7, 26}, {36, 13}, {33, 30}};
  Graph graph{"needles", {}, {}};
  constexpr std::int32_t copies = 40;
  for (std::int32_t copy = 0; copy < copies; ++copy) {
    const std::size_t first = graph.nodes.size();
    for (const Position& node : nodes) graph.nodes.push_back({node.x + 1000 * copy, node.y});
    for (const auto& [from, to] : features) {
      graph.features.push_back(between_nodes(first + from, first + to));
    }
  }
  const auto mesh = built(graph);
  const Work all = (*mesh)->work_used();
  VertexId id;
  ASSERT_EQ((*mesh)->join({20'000 + 40, 43}, id), Status::ok);
  ASSERT_FALSE((*mesh)->is_canonical());
  ASSERT_EQ((*mesh)->canonicalize(), Status::ok);
  EXPECT_LT((*mesh)->work_used().units, all.units / 4);
  EXPECT_EQ((*mesh)->hash(), hash_of_build(**mesh));
}

TEST(Canonical, GoesOnWithMoreWorkWhereItHadTooLittle) {
  const auto mesh = grown(inputs::random_graph(200, inputs::FeatureLength::in_reach, 5));
  ASSERT_FALSE((*mesh)->is_canonical());
  const std::uint32_t standing = (*mesh)->node_count();
  std::uint32_t calls = 0;
  for (std::uint64_t units = 1; !(*mesh)->is_canonical(); units += 1 + units / 8) {
    const Status status = (*mesh)->canonicalize(Work{units});
    ASSERT_LE((*mesh)->work_needed().units, units);
    ASSERT_TRUE(status == Status::ok || status == Status::work_limit) << to_string(status);
    ASSERT_EQ(status == Status::ok, (*mesh)->is_canonical());
    ASSERT_EQ((*mesh)->unresolved(), 0u);
    ++calls;
    ASSERT_LT(calls, 10'000u);
  }
  EXPECT_GT(calls, 1u);
  EXPECT_EQ((*mesh)->node_count(), standing);
  EXPECT_EQ((*mesh)->hash(), hash_of_build(**mesh));
}

// Who has so much work at a time is to know when to stop.
TEST(Canonical, NamesAGroupTwiceWhereItNeedsMoreWorkThanThereIs) {
  const auto mesh = grown(inputs::random_graph(200, inputs::FeatureLength::in_reach, 5));
  std::uint64_t refused = 0, looks = 0;
  for (const std::uint64_t units : {100u, 1000u, 2000u, 4000u, 8000u, 16'000u}) {
    FeatureId last{};
    for (Status status = Status::work_limit; status != Status::ok;) {
      const Picture before = picture_of(**mesh);
      status = (*mesh)->canonicalize(Work{units});
      if (status == Status::ok) continue;
      ASSERT_EQ(status, Status::work_limit);
      const FeatureId feature = (*mesh)->error_detail().feature;
      // It has looked for the groups only: that takes a few calls.
      if (feature.is_none()) {
        EXPECT_TRUE(picture_of(**mesh) == before) << "nothing was laid";
        ASSERT_LT(++looks, 100u);
        continue;
      }
      const bool is_again = feature == last;
      last = feature;
      if (!is_again) continue;
      EXPECT_TRUE(picture_of(**mesh) == before) << "the limit was enough for some group";
      ++refused;
      break;
    }
  }
  EXPECT_GE(refused, 2u);
  EXPECT_EQ((*mesh)->canonicalize(), Status::ok);
  EXPECT_TRUE((*mesh)->is_canonical());
}

TEST(Canonical, WorkTooLittleForAnythingChangesNothing) {
  const auto mesh = grown(inputs::random_graph(100, inputs::FeatureLength::any, 5));
  ASSERT_FALSE((*mesh)->is_canonical());
  const Picture before = picture_of(**mesh);
  ASSERT_EQ((*mesh)->canonicalize(Work{1}), Status::work_limit);
  EXPECT_TRUE(picture_of(**mesh) == before);
  EXPECT_FALSE((*mesh)->is_canonical());
}

constexpr std::int32_t site_side = 3000;

// 250 nodes and features between near ones, made canonical; then so many moves.
std::unique_ptr<OwnedMesh> site_after(int moves, std::uint64_t seed) {
  constexpr std::uint32_t nodes = 250, features = 60;
  constexpr std::int32_t reach = 400;
  inputs::Random random(seed);
  const auto anywhere = [&] {
    return Position{random.between(0, site_side), random.between(0, site_side)};
  };
  const auto any_node = [&] { return vertex_of(random.index(nodes)); };
  auto mesh = empty_mesh();
  VertexId node;
  while ((*mesh)->node_count() < nodes) static_cast<void>((*mesh)->join(anywhere(), node));
  FeatureId feature;
  while ((*mesh)->feature_count() < features) {
    const VertexId from = any_node(), to = any_node();
    const Position a = (*mesh)->position(from), b = (*mesh)->position(to);
    if (std::abs(a.x - b.x) > reach || std::abs(a.y - b.y) > reach) continue;
    static_cast<void>((*mesh)->add_feature({from, to}, feature));
  }
  EXPECT_EQ((*mesh)->canonicalize(), Status::ok);
  for (int i = 0; i < moves; ++i) static_cast<void>((*mesh)->move(any_node(), anywhere()));
  return mesh;
}

TEST(Canonical, TakesAtMostThreeTimesTheWorkOfLayingAllAgain) {
  std::uint64_t compared = 0, longer = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    for (const int moves : {1, 2, 4, 8}) {
      const auto mesh = site_after(moves, seed);
      if ((*mesh)->is_canonical()) continue;
      std::vector<std::byte> bytes((*mesh)->saved_bytes());
      ASSERT_EQ((*mesh)->save(bytes), Status::ok);
      const auto again = empty_mesh();
      ASSERT_EQ((*again)->load(bytes), Status::ok);
      ASSERT_EQ((*again)->rebuild(), Status::ok);
      ASSERT_EQ((*mesh)->canonicalize(), Status::ok);
      ASSERT_EQ((*mesh)->hash(), (*again)->hash());
      const std::uint64_t all = (*again)->work_used().units, some = (*mesh)->work_used().units;
      EXPECT_LE(some, 3 * all) << "seed " << seed << ", " << moves << " moves";
      ++compared;
      if (some > all) ++longer;
    }
  }
  EXPECT_GT(compared, 40u);
  EXPECT_LT(longer, compared / 2);
}

// A place of a change at a time, where no more can be looked at.
TEST(Canonical, NamesNoneSixteenTimesAtTheMostUnlessForEver) {
  constexpr int places_most = 16, ever = 200;
  int stuck = 0, slow = 0;
  for (std::uint64_t units = 20; units < 2000; units += 1 + units / 6) {
    const auto mesh = site_after(7, 5);
    int calls = 0;
    while (calls < ever && (*mesh)->canonicalize(Work{units}) == Status::work_limit &&
           (*mesh)->error_detail().feature.is_none()) {
      ++calls;
    }
    EXPECT_TRUE(calls <= places_most || calls == ever) << units << ": " << calls;
    if (calls == ever) ++stuck;
    if (1 < calls && calls <= places_most) ++slow;
  }
  EXPECT_GT(stuck, 0);
  EXPECT_GT(slow, 0);
}

// It may look at anything, so nobody can say what it depends on.
Parameter split_in_the_middle_of_a_large_mesh(const SplitSite& site) noexcept {
  return site.mesh->node_count() % 2 == 0 ? split_paper(site) : split_default(site);
}

TEST(Canonical, LaysAllAgainUnderAPolicyOfOnesOwn) {
  const auto mesh = built(inputs::random_graph(100, inputs::FeatureLength::any, 5),
                          split_in_the_middle_of_a_large_mesh);
  VertexId id;
  ASSERT_EQ((*mesh)->join({500, 501}, id), Status::ok);
  ASSERT_EQ((*mesh)->canonicalize(), Status::ok);
  EXPECT_EQ((*mesh)->hash(), hash_of_build(**mesh));
}

// Far from all features, so no surroundings have changed; but there is one node more.
TEST(Canonical, LaysAllAgainUnderAPolicyOfOnesOwnWhereverTheChangeWas) {
  const auto mesh = built(inputs::random_graph(100, inputs::FeatureLength::any, 5),
                          split_in_the_middle_of_a_large_mesh);
  VertexId id;
  ASSERT_EQ((*mesh)->join({3'000'000, 3'000'000}, id), Status::ok);
  ASSERT_EQ((*mesh)->canonicalize(), Status::ok);
  EXPECT_EQ((*mesh)->hash(), hash_of_build(**mesh));
}

TEST(Canonical, IsAMeshWhoseFeaturesHaveAllGone) {
  const auto mesh = grown(inputs::random_graph(60, inputs::FeatureLength::any, 5));
  VertexId id;
  for (std::int32_t i = 0; i < 40; ++i) static_cast<void>((*mesh)->join({i * 25, i * 24}, id));
  for (IdValue i = 0; i < (*mesh)->feature_id_end(); ++i) {
    if ((*mesh)->is_feature(FeatureId{i})) {
      ASSERT_EQ((*mesh)->remove_feature(FeatureId{i}), Status::ok);
    }
  }
  ASSERT_EQ((*mesh)->canonicalize(), Status::ok);
  EXPECT_TRUE((*mesh)->is_canonical());
  EXPECT_EQ((*mesh)->hash(), hash_of_build(**mesh));
}

TEST(Canonical, IsAMeshThatAllHaveLeftSinceItChanged) {
  const auto mesh = built({"", {{0, 0}, {100, 0}, {50, 80}}, {between_nodes(0, 1)}});
  VertexId id;
  ASSERT_EQ((*mesh)->join({50, -5}, id), Status::ok);
  ASSERT_EQ((*mesh)->remove_feature(FeatureId{0}), Status::ok);
  ASSERT_EQ((*mesh)->leave(id), Status::ok);
  for (std::size_t i = 0; i < 3; ++i) ASSERT_EQ((*mesh)->leave(vertex_of(i)), Status::ok);
  EXPECT_FALSE((*mesh)->is_canonical());
  EXPECT_EQ((*mesh)->canonicalize(), Status::ok);
  EXPECT_TRUE((*mesh)->is_canonical());
}

TEST(Canonical, IsRefusedWhereBuildLeftAPartUndone) {
  const Graph graph = inputs::random_graph(60, inputs::FeatureLength::any, 5);
  MeshConfig config = inputs::config_for(graph, 100);
  config.steiner_max = 1;
  OwnedMesh mesh(config);
  ASSERT_EQ(mesh->build(graph.nodes, graph.features), Status::steiner_budget);
  EXPECT_FALSE(mesh->is_canonical());
  EXPECT_EQ(mesh->canonicalize(), Status::mesh_unresolved);
}

}  // namespace
}  // namespace etcm::test
