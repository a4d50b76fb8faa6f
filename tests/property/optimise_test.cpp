// Fewer Steiner vertices by trials: never more, still conforming, and the same everywhere.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "etcm/audit.h"
#include "inputs/random.h"
#include "inputs/random_graph.h"
#include "support/emulated.h"
#include "support/families.h"
#include "support/meshes.h"

namespace etcm::test {
namespace {

constexpr std::size_t room = 4000;

std::unique_ptr<OwnedMesh> open_for(const Graph& graph, SplitPolicy policy = split_default) {
  return std::make_unique<OwnedMesh>(inputs::config_for(graph, room, policy));
}

TEST(Optimise, NeedsNoMoreAndGivesTheSameMeshInAnyOrder) {
  std::uint32_t fewer = 0;
  for (std::uint64_t seed = 1; seed <= (is_slow ? 10u : 120u); ++seed) {
    inputs::Random random(seed);
    const Graph graph = graph_of_some_family(random);
    const SplitPolicy policy = random.below(5) == 0 ? split_paper : split_default;
    const auto mesh = open_for(graph, policy), other = open_for(graph, policy);
    if ((*mesh)->build(graph.nodes, graph.features) != Status::ok) continue;
    const std::uint32_t before = (*mesh)->steiner_count();
    const std::uint64_t hash = (*mesh)->hash();
    const auto trials = static_cast<std::uint32_t>(random.between(1, 80));
    const std::uint32_t part = trials / 3;
    ASSERT_EQ((*mesh)->optimise(part), Status::ok);
    ASSERT_EQ((*mesh)->optimise(trials - part, part), Status::ok);
    const Audit result = audit(**mesh);
    ASSERT_TRUE(result) << seed << ", " << graph.name << ": " << to_string(result.broken);
    ASSERT_LE((*mesh)->steiner_count(), before) << seed << ", " << graph.name;
    fewer += before - (*mesh)->steiner_count();

    const Graph turned = shuffled(graph, seed);
    ASSERT_EQ((*other)->build(turned.nodes, turned.features), Status::ok);
    ASSERT_EQ((*other)->optimise(part), Status::ok);
    ASSERT_EQ((*other)->optimise(trials - part, part), Status::ok);
    ASSERT_EQ((*other)->hash(), (*mesh)->hash()) << seed << ", " << graph.name;

    ASSERT_EQ((*mesh)->canonicalize(), Status::ok);
    ASSERT_EQ((*mesh)->hash(), hash) << seed << ", " << graph.name;
  }
  EXPECT_GT(fewer, is_slow ? 5u : 100u);
}

TEST(Optimise, DoesNotDependOnWhatWasBefore) {
  for (std::uint64_t seed = 1; seed <= (is_slow ? 2u : 20u); ++seed) {
    const Graph graph = inputs::random_graph(120, inputs::FeatureLength::any, seed);
    const auto fresh = built(graph), old = grown(shuffled(graph, seed));
    ASSERT_EQ((*old)->canonicalize(), Status::ok);
    ASSERT_EQ((*fresh)->optimise(200), Status::ok);
    ASSERT_EQ((*old)->optimise(200), Status::ok);
    ASSERT_EQ((*old)->hash(), (*fresh)->hash()) << seed;
  }
}

TEST(Optimise, NeedsATenthLessOnLongFeatures) {
  const auto mesh = built(inputs::random_graph(300, inputs::FeatureLength::any, 77));
  const std::uint32_t before = (*mesh)->steiner_count();
  ASSERT_EQ((*mesh)->optimise(4000), Status::ok);
  EXPECT_LT((*mesh)->steiner_count(), before - before / 10);
}

TEST(Optimise, IsNotThereForAMeshThatIsNotWhole) {
  const Graph graph = inputs::random_graph(200, inputs::FeatureLength::any, 3);
  MeshConfig config = inputs::config_for(graph, room);
  config.steiner_max = 5;
  OwnedMesh mesh(config);
  ASSERT_EQ(mesh->build(graph.nodes, graph.features), Status::steiner_budget);
  const Picture before = picture_of(*mesh);
  EXPECT_EQ(mesh->optimise(10), Status::mesh_unresolved);
  EXPECT_EQ(picture_of(*mesh), before);
}

// Nothing that a trial does needs more.
TEST(Optimise, NeedsRoomForNineteenVerticesMoreAndIsWithoutEffectInLess) {
  constexpr std::uint32_t room_of_a_trial = 19;
  std::uint32_t as_good = 0, worse = 0;
  for (std::uint64_t seed = 1; seed <= (is_slow ? 1u : 8u); ++seed) {
    const Graph graph = inputs::random_graph(200, inputs::FeatureLength::any, seed);
    const auto roomy = built(graph);
    const std::uint32_t before = (*roomy)->steiner_count();
    std::vector<std::byte> saved((*roomy)->saved_bytes());
    ASSERT_EQ((*roomy)->save(saved), Status::ok);
    // What build() took out again has left ids free among those in use.
    const std::uint32_t count = (*roomy)->node_count() + before;
    const std::uint32_t ids = (*roomy)->vertex_id_end() - 1;
    ASSERT_EQ((*roomy)->optimise(300), Status::ok);
    for (const std::uint32_t more : {0u, 1u, 4u, 9u, room_of_a_trial, 100u}) {
      const std::uint32_t spare = std::max(ids, count + more) - count;
      MeshConfig config = (*roomy)->config();
      config.vertices_max = count + spare;
      OwnedMesh mesh(config);
      ASSERT_EQ(mesh->load(saved), Status::ok);
      ASSERT_EQ(mesh->optimise(300), Status::ok) << more;
      ASSERT_TRUE(audit(*mesh)) << more;
      ASSERT_LE(mesh->steiner_count(), before);
      const bool is_same = mesh->hash() == (*roomy)->hash();
      if (spare >= room_of_a_trial) {
        EXPECT_TRUE(is_same) << "seed " << seed << ", " << spare;
        ++as_good;
      } else if (!is_same) {
        ++worse;
      }
    }
  }
  EXPECT_GT(as_good, 0u);
  if (!is_slow) {
    EXPECT_GT(worse, 0u) << "or less would do";
  }
}

TEST(Optimise, LeavesAloneWhatHasNoSteinerVertex) {
  const auto mesh = grown({"", square, {between_nodes(0, 2)}});
  const Picture before = picture_of(**mesh);
  EXPECT_EQ((*mesh)->optimise(50), Status::ok);
  EXPECT_EQ(picture_of(**mesh), before);
  EXPECT_EQ((*empty_mesh())->optimise(50), Status::ok);
}

}  // namespace
}  // namespace etcm::test
