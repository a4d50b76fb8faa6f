// etcm size: what to give a mesh, and that it is enough.
#include <gmock/gmock.h>

#include <cstdint>
#include <string>

#include "etcm/config.h"
#include "inputs/owned_mesh.h"
#include "inputs/random_graph.h"
#include "program_run.h"

namespace etcm::cli {
namespace {

using ::testing::HasSubstr;

TEST(SizeOfAMesh, IsToldForEachWidthOfIds) {
  const Outcome outcome = run("size --nodes 200 --features 20");
  EXPECT_EQ(outcome.code, 0);
  const std::uint64_t narrow = storage_bytes_with(2, 520, 40), wide = storage_bytes(520, 40);
  EXPECT_EQ(outcome.output, "MeshStorage<520, 40>\nids of 16 bits: " + std::to_string(narrow) +
                                " bytes\nids of 32 bits: " + std::to_string(wide) + " bytes\n");
  EXPECT_EQ(run("size --nodes 200 --features 20 --json").output,
            "{\"vertices_max\": 520, \"features_max\": 40, \"bytes_16\": " +
                std::to_string(narrow) + ", \"bytes_32\": " + std::to_string(wide) + "}\n");
}

TEST(SizeOfAMesh, SaysWhereIdsOf16BitsAreTooFew) {
  EXPECT_THAT(run("size --nodes 4095").output, HasSubstr("ids of 16 bits: too many"));
  EXPECT_THAT(run("size --nodes 4094 --json").output, HasSubstr("\"bytes_16\": 1"));
  EXPECT_THAT(run("size --nodes 4095 --json").output, HasSubstr("\"bytes_16\": null"));
  EXPECT_EQ(run("size --nodes 0").code, 2);
  EXPECT_EQ(run("size").code, 2);
}

// The rule of capacity_for(): also for what changes and a rebuild have at once.
TEST(SizeOfAMesh, IsEnoughForFeaturesOfAnyLength) {
  for (const std::size_t nodes : {50u, 200u, 1000u}) {
    for (std::uint64_t seed = 0; seed < (nodes < 1000 ? 30u : 3u); ++seed) {
      inputs::Graph graph = inputs::random_graph(nodes, inputs::FeatureLength::any, seed);
      if (graph.features.size() > nodes / 10) graph.features.resize(nodes / 10);
      inputs::OwnedMesh mesh(capacity_for(static_cast<std::uint32_t>(nodes),
                                          static_cast<std::uint32_t>(graph.features.size())));
      ASSERT_EQ(mesh->build(graph.nodes, graph.features), Status::ok) << nodes << ' ' << seed;
      ASSERT_EQ(mesh->remove_feature(FeatureId{0}), Status::ok);
      FeatureId id;
      ASSERT_EQ(mesh->add_feature(graph.features[0], id), Status::ok);
      ASSERT_EQ(mesh->rebuild(), Status::ok) << nodes << ' ' << seed;
    }
  }
}

}  // namespace
}  // namespace etcm::cli
