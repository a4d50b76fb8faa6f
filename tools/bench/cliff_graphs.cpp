#include "bench/cliff_graphs.h"

#include <cmath>

#include "inputs/direction.h"
#include "inputs/patterns.h"
#include "inputs/random_graph.h"

namespace etcm::bench {

using inputs::between_nodes;
using inputs::Graph;

namespace {

constexpr std::int32_t ring_radius = position_max - 1;

std::int32_t to_coordinate(std::size_t i) { return static_cast<std::int32_t>(i); }

}  // namespace

Graph ring(std::size_t count) {
  Graph graph{"ring", {{0, 0}}, {}};
  for (std::size_t i = 0; i < count; ++i) {
    const auto angle =
        static_cast<std::int32_t>(std::uint64_t{inputs::full_turn_millidegrees} * i / count);
    graph.nodes.push_back(inputs::at_angle({0, 0}, angle, ring_radius));
  }
  return graph;
}

Graph line(std::size_t count) {
  Graph graph{"line", {{to_coordinate(count / 2), far_away}}, {}};
  for (std::size_t i = 0; i < count; ++i) graph.nodes.push_back({to_coordinate(i), 0});
  return graph;
}

Graph star(std::size_t count) {
  Graph graph = ring(count);
  for (std::size_t i = 1; i <= count; ++i) graph.features.push_back(between_nodes(0, i));
  return graph;
}

Graph grid(std::size_t count) {
  Graph graph{"grid", {}, {}};
  const auto side = static_cast<std::size_t>(std::sqrt(static_cast<double>(count)));
  for (std::size_t i = 0; i < side * side; ++i) {
    graph.nodes.push_back({to_coordinate(100 * (i % side)), to_coordinate(100 * (i / side))});
  }
  return graph;
}

Graph long_feature(std::size_t count) {
  Graph graph{"feature", {}, {}};
  for (std::size_t i = 0; i < count; ++i) graph.nodes.push_back({to_coordinate(100 * i), 0});
  graph.features.push_back(between_nodes(0, count - 1));
  return graph;
}

Graph beset_feature(std::size_t count) {
  Graph graph = long_feature(count);
  for (std::size_t i = 1; i < count; ++i) {
    const std::int32_t x = to_coordinate(100 * i - 50);
    graph.nodes.push_back({x, 3});
    graph.nodes.push_back({x + 1, -3});
  }
  return graph;
}

Graph parallels(std::size_t count) {
  Graph graph{"parallels", {}, {}};
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t y = to_coordinate(100 * i);
    graph.nodes.push_back({0, y});
    graph.nodes.push_back({far_away, y});
    graph.features.push_back(between_nodes(2 * i, 2 * i + 1));
  }
  return graph;
}

Graph cluster(std::size_t count) {
  Graph graph = inputs::random_nodes(count, 1);
  graph.nodes.insert(graph.nodes.begin(), {-far_away, -far_away});
  return graph;
}

Graph even(std::size_t nodes) {
  return inputs::random_graph(nodes, inputs::FeatureLength::in_reach, 1);
}

Graph circles(std::size_t count) {
  const Graph circle = inputs::exact_circle(0, 1);
  Graph graph{"circles", {}, {}};
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t which = i / circle.nodes.size();
    const Position node = circle.nodes[i % circle.nodes.size()];
    graph.nodes.push_back({node.x + to_coordinate(70'000 * which), node.y});
  }
  return graph;
}

}  // namespace etcm::bench
