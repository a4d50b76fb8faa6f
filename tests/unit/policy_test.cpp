// A policy of one's own can do what the default does: the default's source, compiled here as any
// program's own with the public headers alone, makes the same mesh.
#include "etcm/policy.h"

#include <gtest/gtest.h>

#include "etcm/audit.h"
#include "etcm/split_site.h"
#include "inputs/owned_mesh.h"
#include "inputs/random_graph.h"
#include "support/split_in_the_middle.h"

// The names under which CMakeLists.txt has the source compiled.
namespace etcm {
inline namespace ETCM_IDS {
Parameter own_paper(const SplitSite& site) noexcept;
Parameter own_default(const SplitSite& site) noexcept;
}  // namespace ETCM_IDS
}  // namespace etcm

namespace etcm::test {
namespace {

struct Made {
  std::uint64_t hash;
  std::uint32_t steiner_count;
};

Made made(const inputs::Graph& graph, SplitPolicy policy) {
  inputs::OwnedMesh mesh(inputs::config_for(graph, 4 * graph.nodes.size() + 1000, policy));
  EXPECT_EQ(mesh->build(graph.nodes, graph.features), Status::ok);
  return {mesh->hash(), mesh->steiner_count()};
}

TEST(OwnPolicy, CanDoWhatThoseOfTheLibraryDo) {
  const inputs::Graph graph = inputs::random_graph(500, inputs::FeatureLength::any, 7);
  const Made by_default = made(graph, split_default), by_paper = made(graph, split_paper);
  ASSERT_GT(by_default.steiner_count, 100u);
  ASSERT_NE(by_default.hash, by_paper.hash);
  EXPECT_EQ(made(graph, own_default).hash, by_default.hash);
  EXPECT_EQ(made(graph, own_paper).hash, by_paper.hash);
}

struct Numbered {
  SplitPolicy rule;
  unsigned calls;
};

Parameter count_and_ask(const SplitSite& site) noexcept {
  auto& numbered = *static_cast<Numbered*>(site.context);
  ++numbered.calls;
  return numbered.rule(site);
}

TEST(OwnPolicy, FindsInItsSiteWhatTheConfigurationGaveIt) {
  const inputs::Graph graph = inputs::random_graph(300, inputs::FeatureLength::any, 7);
  for (const SplitPolicy rule : {split_default, split_paper}) {
    Numbered numbered{rule, 0};
    MeshConfig config = inputs::config_for(graph, 4 * graph.nodes.size() + 1000, count_and_ask);
    config.policy_context = &numbered;
    inputs::OwnedMesh mesh(config);
    ASSERT_EQ(mesh->build(graph.nodes, graph.features), Status::ok);
    EXPECT_EQ(mesh->hash(), made(graph, rule).hash);
    EXPECT_GE(numbered.calls, mesh->steiner_count());
  }
}

TEST(OwnPolicy, MayLeaveBothPartsOfASegmentToBeSplitAgain) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const inputs::Graph graph = inputs::random_graph(300, inputs::FeatureLength::any, seed);
    inputs::OwnedMesh mesh(inputs::config_for(graph, 20'000, split_in_the_middle));
    ASSERT_EQ(mesh->build(graph.nodes, graph.features), Status::ok) << seed;
    EXPECT_TRUE(bool(audit(*mesh))) << seed;
  }
}

// Two features side by side, nearer than the points of their grids: neither can meet the other's
// vertices well, and to aim at them all the same took a vertex at each point of both grids.
TEST(DefaultPolicy, DoesNotSplitStepByStepBesideAFeatureNearerThanItsGrid) {
  const inputs::Graph graph{"three clusters",
                            {{-157347, -10953064},
                             {-12208166, 12862177},
                             {-157348, -10953049},
                             {2666, 3618495},
                             {2666, 3618489},
                             {-12208151, 12862177},
                             {-12208151, 12862172},
                             {-12208151, 12862187},
                             {2675, 3618489},
                             {-157351, -10953056},
                             {-157338, -10953051},
                             {-12208161, 12862176},
                             {2667, 3618503}},
                            {inputs::between_nodes(12, 5), inputs::between_nodes(0, 11),
                             inputs::between_nodes(0, 4), inputs::between_nodes(2, 3)}};
  EXPECT_LT(made(graph, split_default).steiner_count, 20u);
}

}  // namespace
}  // namespace etcm::test
