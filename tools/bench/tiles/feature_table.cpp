#include "bench/tiles/feature_table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/tiles/emptiness.h"
#include "bench/tiles/feature_changes.h"
#include "bench/tiles/laying.h"
#include "inputs/owned_mesh.h"
#include "inputs/placer.h"
#include "inputs/random.h"
#include "inputs/random_graph.h"

namespace etcm::bench {

namespace {

using inputs::Graph;

// Features of so many spacings at most, one that is tried for so many nodes.
struct Kind {
  std::int32_t spacings;
  std::size_t nodes_each;
};
constexpr Kind kinds[] = {{4, 7},   {4, 10},  {4, 14},   {4, 20},
                          {4, 100}, {20, 20}, {20, 100}, {100, 1000}};

std::int32_t spacing_of(const Graph& graph) {
  const double side = inputs::random_graph_side(graph.nodes.size());
  return std::max(
      1, static_cast<std::int32_t>(side / std::sqrt(static_cast<double>(graph.nodes.size()))));
}

Graph graph_with(const Kind& kind, std::size_t nodes, std::uint64_t seed) {
  Graph graph = inputs::random_nodes(nodes, seed);
  inputs::Random random(seed);
  inputs::Placer placer(graph.nodes, kind.spacings * spacing_of(graph));
  for (std::size_t i = 0; i < nodes; i += kind.nodes_each) {
    for (int attempt = 0; attempt < 20; ++attempt) {
      if (placer.try_add(i, placer.random_near(i, random))) break;
    }
  }
  graph.features = placer.features();
  return graph;
}

void build(inputs::OwnedMesh& mesh, const Graph& graph) {
  if (mesh->build(graph.nodes, graph.features) != Status::ok) {
    throw std::runtime_error("a mesh with features fails");
  }
}

// The tiles that hold any place of what each feature reads.
std::vector<std::vector<std::uint32_t>> tiles_read(const Mesh& nodes, const Reads& reads,
                                                   const QuadTree& tree) {
  std::vector<std::vector<std::uint32_t>> tiles_of(nodes.triangle_count());
  for (std::uint32_t i = 0; i < nodes.triangle_count(); ++i) {
    const Emptiness empty =
        Emptiness::of(nodes, nodes.triangle(TriangleId{static_cast<IdValue>(i)}));
    tree.for_each_cell([&](std::uint32_t, const Square& square) { return empty.meets(square); },
                       [&](std::uint32_t tile) { tiles_of[i].push_back(tile); });
  }
  std::vector<std::vector<std::uint32_t>> read;
  for (const auto& triangles : reads.triangles) {
    std::vector<bool> is_read(tree.cell_count());
    for (const std::uint32_t triangle : triangles) {
      for (const std::uint32_t tile : tiles_of[triangle]) is_read[tile] = true;
    }
    read.emplace_back();
    for (std::uint32_t i = 0; i < is_read.size(); ++i) {
      if (is_read[i]) read.back().push_back(i);
    }
  }
  return read;
}

struct Proved {
  Distribution read_tiles;       // of what a feature reads itself
  Distribution closed_features;  // that it depends on, with itself
  Distribution closed_tiles;     // of what they read
  Distribution group_features;   // by the Steiner vertices that stand
};

Proved proved(const Graph& graph, const Mesh& nodes, const Mesh& whole, const Reads& reads,
              const QuadTree& tree) {
  Proved found;
  const auto read = tiles_read(nodes, reads, tree);
  for (std::size_t i = 0; i < graph.features.size(); ++i) {
    std::vector<bool> is_read(tree.cell_count());
    for (const std::uint32_t feature : reads.closed[i]) {
      for (const std::uint32_t tile : read[feature]) is_read[tile] = true;
    }
    found.read_tiles.add(static_cast<double>(read[i].size()));
    found.closed_features.add(static_cast<double>(reads.closed[i].size()));
    found.closed_tiles.add(static_cast<double>(std::count(is_read.begin(), is_read.end(), true)));
  }
  for (const std::uint32_t size : group_sizes(graph, whole)) found.group_features.add(size);
  return found;
}

// How many of some features are laid as in the one mesh from what they depend on alone.
std::size_t laid_alike(const Graph& graph, const Mesh& nodes, const Mesh& whole, const Reads& reads,
                       std::size_t samples, inputs::Random random) {
  std::size_t alike = 0;
  for (std::size_t i = 0; i < samples; ++i) {
    const std::size_t feature = random.index(graph.features.size());
    alike += is_laid_alike(graph, nodes, whole, reads, reads.closed[feature]) ? 1 : 0;
  }
  return alike;
}

// Of tiles that are not at the border of the site, where the hull alone asks for much.
std::string knowledge(const Graph& graph, const Mesh& whole, const QuadTree& tree) {
  const std::int32_t side = inputs::random_graph_side(graph.nodes.size());
  Distribution spacings;
  std::size_t never = 0;
  for (std::uint32_t i = 0; i < tree.cell_count(); ++i) {
    const Square tile = tree.square(tree.cell(i));
    const bool is_at_border =
        tile.low.x == 0 || tile.low.y == 0 || tile.high.x >= side || tile.high.y >= side;
    if (is_at_border) continue;
    const auto least = least_knowledge(graph, whole, tile, spacing_of(graph));
    never += least ? 0 : 1;
    if (least) spacings.add(*least);
  }
  return spacings.text(0) + (never > 0 ? ", never " + std::to_string(never) : "");
}

bool print_kind(const Kind& kind, const FeatureTableOptions& options) {
  const Graph graph = graph_with(kind, options.nodes, options.seed);
  Graph bare;
  bare.nodes = graph.nodes;
  inputs::OwnedMesh nodes(inputs::config_for(bare, 0));
  build(nodes, bare);
  inputs::OwnedMesh whole(inputs::config_for(graph, 3 * graph.nodes.size()));
  build(whole, graph);
  std::vector<std::uint64_t> codes;
  for (const Position node : graph.nodes) codes.push_back(morton_code(node));
  std::sort(codes.begin(), codes.end());
  int bits = 1;
  while ((std::int32_t{1} << bits) <= inputs::random_graph_side(graph.nodes.size())) ++bits;
  const QuadTree tree(codes, bits,
                      static_cast<std::uint32_t>(2 * graph.nodes.size() / options.tiles));
  const Reads reads = reads_of(graph, *nodes);
  Proved found = proved(graph, *nodes, *whole, reads, tree);
  const std::size_t samples = std::min(options.samples, graph.features.size());
  const std::size_t alike =
      laid_alike(graph, *nodes, *whole, reads, samples, inputs::Random(options.seed));
  const std::string known = knowledge(graph, *whole, tree);
  const std::uint32_t steiner = whole->steiner_count();
  Changes changes = changes_without(graph, *whole, tree, samples, spacing_of(graph), options.seed);
  std::printf("| %d | %zu | %u | %u | %s | %s | %s | %zu of %zu | %s | %.0f %% | %s | %s | %s |\n",
              kind.spacings, graph.features.size(), steiner, tree.cell_count(),
              found.read_tiles.text(0).c_str(), found.closed_features.text(0).c_str(),
              found.closed_tiles.text(0).c_str(), alike, samples,
              found.group_features.text(0).c_str(),
              100 * static_cast<double>(changes.lone) / static_cast<double>(samples),
              changes.tiles.text(0).c_str(), changes.spacings.text(1).c_str(), known.c_str());
  std::fflush(stdout);
  return alike == samples;
}

}  // namespace

bool print_feature_table(const FeatureTableOptions& options) {
  std::puts(
      "| spacings, at most | features | Steiner | tiles | tiles read by itself | features depended"
      " on | their tiles | laid from these alone: alike | group | changes nothing else |"
      " tiles changed | spacings away | spacings a tile must know |\n"
      "|---:|---:|---:|---:|---|---|---|---|---|---:|---|---|---|");
  bool is_all_alike = true;
  for (const Kind& kind : kinds) is_all_alike &= print_kind(kind, options);
  return is_all_alike;
}

}  // namespace etcm::bench
