// Small graphs for RapidCheck, which shrinks them.
#pragma once

#include <rapidcheck/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "inputs/placer.h"
#include "inputs/random.h"
#include "support/meshes.h"

namespace etcm::test {

// Few enough places that nodes are often collinear or cocircular.
inline std::vector<Position> any_nodes() {
  auto nodes = *rc::gen::container<std::vector<std::pair<std::int32_t, std::int32_t>>>(
      rc::gen::pair(rc::gen::inRange(-8, 9), rc::gen::inRange(-8, 9)));
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  std::vector<Position> positions;
  for (const auto& [x, y] : nodes) positions.push_back({x, y});
  return positions;
}

inline Graph any_graph() {
  Graph graph{"", any_nodes(), {}};
  const std::uint64_t seed = *rc::gen::inRange<std::uint64_t>(0, 1000);
  if (graph.nodes.size() < 2) return graph;
  inputs::Placer placer(graph.nodes, 100);
  inputs::Random random(seed);
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    const std::size_t from = random.index(graph.nodes.size());
    placer.try_add(from, random.index(graph.nodes.size()));
  }
  graph.features = placer.features();
  return graph;
}

}  // namespace etcm::test
