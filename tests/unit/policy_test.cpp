// A policy of one's own can do what the default does: the default's source, compiled here as any
// program's own with the public headers alone, makes the same mesh.
#include "etcm/policy.h"

#include <gtest/gtest.h>

#include "inputs/owned_mesh.h"
#include "inputs/random_graph.h"

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

}  // namespace
}  // namespace etcm::test
