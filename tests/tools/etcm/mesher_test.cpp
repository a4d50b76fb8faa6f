#include "mesher.h"

#include <gtest/gtest.h>

#include "etcm/split_site.h"

namespace etcm::cli {
namespace {

int split_count = 0;

Parameter counted_split(const SplitSite& site) noexcept {
  ++split_count;
  return split_default(site);
}

// A long feature between two rows of nodes: it needs Steiner vertices.
files::GridGraph comb_on_grid() {
  files::GridGraph grid;
  grid.nodes = {{0, 0}, {1000, 0}};
  for (int i = 0; i < 20; ++i) grid.nodes.push_back({50 + (i / 2) * 100, i % 2 == 0 ? 9 : -9});
  grid.features = {{VertexId{1}, VertexId{2}}};
  return grid;
}

// To measure is for the bench: here one build is made, and its clock is looked at on the way.
TEST(Mesher, BuildsOnce) {
  const files::GridGraph grid = comb_on_grid();
  inputs::OwnedMesh mesh({.vertices_max = 200, .features_max = 1, .policy = counted_split});
  ASSERT_EQ(mesh->build(grid.nodes, grid.features), Status::ok);
  const int splits_of_one_build = split_count;
  ASSERT_GT(splits_of_one_build, 0);

  split_count = 0;
  const Meshed meshed = build_mesh({}, grid, {.policy = counted_split});
  EXPECT_EQ(meshed.status, Status::ok);
  EXPECT_EQ(split_count, splits_of_one_build);
  EXPECT_EQ((*meshed.mesh)->hash(), mesh->hash());
  EXPECT_GE(meshed.delaunay_us, 0);
  EXPECT_GE(meshed.conform_us, 0);
}

}  // namespace
}  // namespace etcm::cli
