// Small graphs for RapidCheck, which shrinks them, and meshes of them.
#pragma once

#include <rapidcheck/gtest.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "inputs/patterns.h"
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

// A mesh of the graph: as build() makes it, or on what all have left who stood there before.
inline std::unique_ptr<OwnedMesh> any_mesh_of(const Graph& graph) {
  if (*rc::gen::inRange(0, 2) == 0) return built(graph);
  auto mesh = empty_mesh(4000, 1000);
  const Graph comb = inputs::comb(5, 10, 100, 3);
  RC_ASSERT((*mesh)->build(comb.nodes, comb.features) == Status::ok);
  for (IdValue value = 0; value < (*mesh)->feature_id_end(); ++value) {
    RC_ASSERT((*mesh)->remove_feature(FeatureId{value}) == Status::ok);
  }
  for (std::size_t i = 0; i < comb.nodes.size(); ++i) {
    RC_ASSERT((*mesh)->leave(vertex_of(i)) == Status::ok);
  }
  std::vector<VertexId> ids(graph.nodes.size());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    RC_ASSERT((*mesh)->join(graph.nodes[i], ids[i]) == Status::ok);
  }
  for (const FeatureEnds& ends : graph.features) {
    FeatureId id;
    RC_ASSERT((*mesh)->add_feature(
                  {ids[inputs::node_index_of(ends.from)], ids[inputs::node_index_of(ends.to)]},
                  id) == Status::ok);
  }
  return mesh;
}

}  // namespace etcm::test
