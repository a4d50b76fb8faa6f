#include "inputs/random_graph.h"

#include <algorithm>
#include <set>
#include <utility>

#include "inputs/direction.h"
#include "inputs/placer.h"
#include "inputs/random.h"

namespace etcm::inputs {
namespace {

constexpr std::int32_t smallest_side = 1000;
constexpr std::size_t densest_nodes = 5000;

std::int64_t distance_squared(Position a, Position b) noexcept {
  const std::int64_t dx = std::int64_t{a.x} - b.x;
  const std::int64_t dy = std::int64_t{a.y} - b.y;
  return dx * dx + dy * dy;
}

// The least root whose square is not below the value.
std::int64_t root_up(std::int64_t value) noexcept {
  std::int64_t low = 0;
  std::int64_t high = std::int64_t{1} << 31;
  while (low < high) {
    const std::int64_t middle = (low + high) / 2;
    if (middle * middle < value) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

class DistinctNodes {
 public:
  void add(Position node) {
    if (in_range(node) && taken_.insert({node.x, node.y}).second) nodes_.push_back(node);
  }
  std::size_t size() const noexcept { return nodes_.size(); }
  std::vector<Position> take() { return std::move(nodes_); }

 private:
  std::set<std::pair<std::int32_t, std::int32_t>> taken_;
  std::vector<Position> nodes_;
};

std::vector<Position> uniform_nodes(std::size_t count, Random& random) {
  const std::int32_t side = random_graph_side(count);
  DistinctNodes nodes;
  while (nodes.size() < count) {
    const std::int32_t x = random.between(0, side);
    const std::int32_t y = random.between(0, side);
    nodes.add({x, y});
  }
  return nodes.take();
}

// Tries random pairs until there are `wanted` features, or until so many pairs in a row did not
// fit that the graph is as good as full.
void place_features(Placer& placer, std::span<const Position> nodes, std::size_t wanted,
                    std::int64_t reach_squared, Random& random) {
  constexpr std::size_t patience = 2'000'000;
  for (std::size_t failures = 0; placer.features().size() < wanted && failures < patience;
       ++failures) {
    const std::size_t from = random.index(nodes.size());
    const std::size_t to = placer.random_near(from, random);
    if (distance_squared(nodes[from], nodes[to]) > reach_squared) continue;
    if (placer.try_add(from, to)) failures = 0;
  }
}

}  // namespace

std::int32_t random_graph_side(std::size_t nodes) noexcept {
  if (nodes <= densest_nodes) return smallest_side;
  constexpr std::int64_t area = std::int64_t{smallest_side} * smallest_side;
  return static_cast<std::int32_t>(
      root_up(area * static_cast<std::int64_t>(nodes) / static_cast<std::int64_t>(densest_nodes)));
}

Graph random_graph(std::size_t nodes, FeatureLength length, std::uint64_t seed) {
  const bool any = length == FeatureLength::any;
  Random random(seed * 2 + (any ? 0 : 1));
  Graph graph;
  graph.name =
      "random-" + std::to_string(nodes) + (any ? "-long-" : "-short-") + std::to_string(seed);
  graph.nodes = uniform_nodes(nodes, random);
  if (nodes < 2) return graph;

  const std::int64_t side = random_graph_side(nodes);
  const std::int64_t reach_squared =
      any ? 2 * side * side : 16 * side * side / static_cast<std::int64_t>(nodes);
  const std::int64_t cell_size = any ? side + 1 : std::max<std::int64_t>(root_up(reach_squared), 1);
  Placer placer(graph.nodes, static_cast<std::int32_t>(cell_size));
  place_features(placer, graph.nodes, nodes * 15 / 100, reach_squared, random);
  graph.features = placer.features();
  return graph;
}

Graph random_nodes(std::size_t nodes, std::uint64_t seed) {
  Random random(seed);
  return {"nodes-" + std::to_string(nodes), uniform_nodes(nodes, random), {}};
}

Graph random_polygon(std::size_t nodes, std::uint64_t seed) {
  Random random(seed);
  Graph graph{"polygon-" + std::to_string(nodes), {}, {}};
  const auto step = full_turn_millidegrees / static_cast<std::int32_t>(nodes);
  for (std::size_t i = 0; i < nodes; ++i) {
    const std::int32_t distance = random.between(3000, 10000);
    graph.nodes.push_back(at_angle({0, 0}, static_cast<std::int32_t>(i) * step, distance));
    graph.features.push_back(between_nodes(i, (i + 1) % nodes));
  }
  return graph;
}

Graph random_clusters(std::size_t clusters, std::size_t nodes_each, std::uint64_t seed) {
  Random random(seed);
  DistinctNodes nodes;
  for (std::size_t cluster = 0; cluster < clusters; ++cluster) {
    const Position centre{random.between(0, 100'000), random.between(0, 100'000)};
    while (nodes.size() < (cluster + 1) * nodes_each) {
      const std::int32_t angle = random.between(0, full_turn_millidegrees - 1);
      nodes.add(at_angle(centre, angle, random.between(0, 1000)));
    }
  }
  Graph graph{
      "clusters-" + std::to_string(clusters) + "x" + std::to_string(nodes_each), nodes.take(), {}};
  shuffle(graph.nodes, random);
  Placer placer(graph.nodes, 2 * position_max);
  place_features(placer, graph.nodes, graph.nodes.size() * 15 / 100, std::int64_t{1} << 60, random);
  graph.features = placer.features();
  return graph;
}

}  // namespace etcm::inputs
