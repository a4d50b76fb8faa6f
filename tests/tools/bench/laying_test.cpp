// What laying a feature is said to depend on: held against the mesh, and against what is laid from
// that alone.
#include "bench/tiles/laying.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "bench/tiles/feature_changes.h"
#include "etcm/predicates.h"
#include "inputs/owned_mesh.h"
#include "inputs/placer.h"
#include "inputs/random.h"
#include "inputs/random_graph.h"

namespace etcm::bench {
namespace {

using inputs::FeatureLength;
using inputs::Graph;

// Every so many of its features, so that not all depend on all.
Graph thinned_graph(FeatureLength length, std::size_t nodes, std::size_t each, std::uint64_t seed) {
  Graph graph = inputs::random_graph(nodes, length, seed);
  std::vector<FeatureEnds> features;
  for (std::size_t i = 0; i < graph.features.size(); i += each) {
    features.push_back(graph.features[i]);
  }
  graph.features = features;
  return graph;
}

// Ties everywhere: which triangles there are is up to the features.
Graph lattice_graph(std::int32_t columns, std::size_t each, std::uint64_t seed) {
  Graph graph;
  for (std::int32_t x = 0; x < columns; ++x) {
    for (std::int32_t y = 0; y < columns; ++y) graph.nodes.push_back({.x = 10 * x, .y = 10 * y});
  }
  inputs::Placer placer(graph.nodes, 40);
  inputs::Random random(seed);
  for (std::size_t i = 0; i < graph.nodes.size(); i += each) {
    static_cast<void>(placer.try_add(i, placer.random_near(i, random)));
  }
  graph.features = placer.features();
  return graph;
}

struct LaidGraph {
  explicit LaidGraph(const Graph& graph)
      : nodes(inputs::config_for(graph, 0)), whole(inputs::config_for(graph, 10'000)) {
    EXPECT_EQ(nodes->build(graph.nodes, {}), Status::ok);
    EXPECT_EQ(whole->build(graph.nodes, graph.features), Status::ok);
  }
  inputs::OwnedMesh nodes;
  inputs::OwnedMesh whole;
};

// Places along the line that are inside of a disk, strictly, beside what is found.
TEST(Touching, FindsEachTriangleWhoseDiskHasAPlaceOfTheLine) {
  const Graph graph = thinned_graph(FeatureLength::any, 400, 3, 1);
  const LaidGraph laid(graph);
  Touching touching(*laid.nodes);
  for (const FeatureEnds& ends : graph.features) {
    const std::vector<std::uint32_t> found = touching.triangles(ends.from, ends.to);
    const Point from = laid.nodes->point(ends.from), to = laid.nodes->point(ends.to);
    for (std::uint32_t i = 0; i < laid.nodes->triangle_count(); ++i) {
      const Triangle triangle = laid.nodes->triangle(TriangleId{static_cast<IdValue>(i)});
      if (triangle.is_ghost()) continue;
      const auto corner = [&](std::size_t k) { return laid.nodes->point(triangle.corner[k]); };
      bool is_inside = false;
      for (int step = 1; step < 64 && !is_inside; ++step) {
        const Point place{.x = from.x + (to.x - from.x) / 64 * step,
                          .y = from.y + (to.y - from.y) / 64 * step};
        is_inside = incircle(corner(0), corner(1), corner(2), place) > 0;
      }
      if (is_inside) {
        EXPECT_TRUE(std::binary_search(found.begin(), found.end(), i));
      }
    }
  }
}

TEST(Laying, OfWhatIsSaidToBeEnoughIsThatOfTheOneMesh) {
  std::size_t parts = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    const FeatureLength length = seed % 2 == 0 ? FeatureLength::any : FeatureLength::in_reach;
    const Graph graph = thinned_graph(length, 500, seed % 2 == 0 ? 8 : 2 + seed % 4, seed);
    const LaidGraph laid(graph);
    const Reads reads = reads_of(graph, *laid.nodes);
    for (const std::vector<std::uint32_t>& closed : reads.closed) {
      parts += closed.size() < graph.features.size() ? 1 : 0;
      EXPECT_TRUE(is_laid_alike(graph, *laid.nodes, *laid.whole, reads, closed));
    }
  }
  EXPECT_GT(parts, 100u);
}

TEST(Laying, WithTiesEverywhereOfWhatIsSaidToBeEnoughIsThatOfTheOneMesh) {
  std::size_t parts = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    const Graph graph = lattice_graph(22, 5 + 5 * (seed % 4), seed);
    const LaidGraph laid(graph);
    const Reads reads = reads_of(graph, *laid.nodes);
    for (const std::vector<std::uint32_t>& closed : reads.closed) {
      parts += closed.size() < graph.features.size() ? 1 : 0;
      EXPECT_TRUE(is_laid_alike(graph, *laid.nodes, *laid.whole, reads, closed));
    }
  }
  EXPECT_GT(parts, 100u);
}

// Where others are near, a feature by itself is laid otherwise: that much is not too little to see.
TEST(Laying, OfAFeatureByItselfIsOftenNot) {
  const Graph graph = thinned_graph(FeatureLength::in_reach, 500, 1, 3);
  const LaidGraph laid(graph);
  const Reads reads = reads_of(graph, *laid.nodes);
  std::size_t otherwise = 0;
  for (std::uint32_t i = 0; i < graph.features.size(); ++i) {
    otherwise += is_laid_alike(graph, *laid.nodes, *laid.whole, reads, {i}) ? 0 : 1;
  }
  EXPECT_GT(otherwise, 10u);
}

// Two far from each other and one by itself, on a grid: by hand.
TEST(Laying, DependsOnThoseWhoseLinesAreNear) {
  Graph graph;
  for (std::int32_t x = 0; x < 40; ++x) {
    for (std::int32_t y = 0; y < 40; ++y) graph.nodes.push_back({.x = 10 * x, .y = 10 * y});
  }
  const auto node = [](std::size_t x, std::size_t y) { return inputs::vertex_of(40 * x + y); };
  graph.features = {
      {node(5, 5), node(8, 6)}, {node(5, 6), node(8, 7)}, {node(30, 30), node(33, 31)}};
  const LaidGraph laid(graph);
  const Reads reads = reads_of(graph, *laid.nodes);
  EXPECT_EQ(reads.closed[0], (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(reads.closed[1], (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(reads.closed[2], (std::vector<std::uint32_t>{2}));
  EXPECT_EQ(group_sizes(graph, *laid.whole)[2], 1u);
}

// Who shares a node with another may be laid at the same distances from it, at any angle.
TEST(Laying, DependsOnThoseThatLeaveTheSameNode) {
  Graph graph;
  for (std::int32_t x = 0; x < 40; ++x) {
    for (std::int32_t y = 0; y < 40; ++y) graph.nodes.push_back({.x = 10 * x, .y = 10 * y});
  }
  const auto node = [](std::size_t x, std::size_t y) { return inputs::vertex_of(40 * x + y); };
  graph.features = {{node(20, 20), node(26, 25)}, {node(20, 20), node(14, 15)}};
  const LaidGraph laid(graph);
  EXPECT_EQ(reads_of(graph, *laid.nodes).closed[0], (std::vector<std::uint32_t>{0, 1}));
}

// What is seen to be otherwise without a feature is no more than what is said to depend on it.
TEST(Changes, WithoutAFeatureLeaveTheRestAsItWasAndTheMeshWhole) {
  const Graph graph = thinned_graph(FeatureLength::in_reach, 500, 2, 5);
  LaidGraph laid(graph);
  const std::uint64_t hash = laid.whole->hash();
  std::vector<std::uint64_t> codes;
  for (const Position node : graph.nodes) codes.push_back(morton_code(node));
  std::sort(codes.begin(), codes.end());
  const QuadTree tree(codes, 10, 100);
  Changes changes = changes_without(graph, *laid.whole, tree, 30, 40, 1);
  EXPECT_EQ(laid.whole->hash(), hash);
  EXPECT_EQ(changes.tiles.count(), 30u);
  EXPECT_GE(changes.tiles.quantile(0), 1);
  EXPECT_LE(changes.tiles.quantile(1), tree.cell_count());
}

TEST(LeastKnowledge, IsFoundForEachTile) {
  const Graph graph = thinned_graph(FeatureLength::in_reach, 500, 4, 6);
  const LaidGraph laid(graph);
  const Square middle{.low = {.x = 400, .y = 400}, .high = {.x = 600, .y = 600}};
  const auto least = least_knowledge(graph, *laid.whole, middle, 45);
  ASSERT_TRUE(least.has_value());
  EXPECT_GE(*least, 1);
  EXPECT_LE(*least, 16);
}

}  // namespace
}  // namespace etcm::bench
