#include "compare/lone.h"

#include <algorithm>

#include "etcm/policy.h"
#include "etcm/predicates.h"

namespace etcm::compare {
namespace {

// A feature and the nodes beside it.
class LoneFeature {
 public:
  explicit LoneFeature(const inputs::Graph& graph)
      : from_(graph.nodes[inputs::node_index_of(graph.features.front().from)]),
        to_(graph.nodes[inputs::node_index_of(graph.features.front().to)]) {
    for (const Position node : graph.nodes) {
      const Point point = to_point(node);
      const int side = orient2d(at(0), at(parameter_end), point);
      if (side > 0) left_.push_back(point);
      if (side < 0) right_.push_back(point);
    }
  }

  // Whether some circle through the two places has no node inside. The node on the left that sees
  // them under the greatest angle gives the circle that leans furthest to the right.
  bool can_be_edge(Parameter head, Parameter tail) const {
    if (left_.empty()) return true;
    const Point a = at(head), b = at(tail);
    const Point* foremost = &left_.front();
    for (const Point& node : left_) {
      if (incircle(a, b, *foremost, node) > 0) foremost = &node;
    }
    return std::none_of(right_.begin(), right_.end(),
                        [&](const Point& node) { return incircle(a, b, *foremost, node) > 0; });
  }

  // The furthest place that makes an edge with this one.
  Parameter furthest_from(Parameter head) const {
    Parameter low = head + 1, high = parameter_end;
    while (low < high) {
      const Parameter middle = low + (high - low + 1) / 2;
      if (can_be_edge(head, middle)) {
        low = middle;
      } else {
        high = middle - 1;
      }
    }
    return low;
  }

 private:
  Point at(Parameter t) const {
    return {from_.x * subunits_per_unit + t * (std::int64_t{to_.x} - from_.x),
            from_.y * subunits_per_unit + t * (std::int64_t{to_.y} - from_.y)};
  }

  Position from_;
  Position to_;
  std::vector<Point> left_;
  std::vector<Point> right_;
};

}  // namespace

std::vector<System> lone_systems() {
  std::vector<System> systems;
  for (const auto& list : {all_systems(), other_readings()}) {
    std::copy_if(list.begin(), list.end(), std::back_inserter(systems),
                 [](const System& system) { return system.conforms; });
  }
  return systems;
}

inputs::Graph lone_graph(std::size_t nodes, std::uint64_t seed) {
  inputs::Graph graph = inputs::random_graph(nodes, inputs::FeatureLength::any, seed);
  graph.name += "-alone";
  graph.features.resize(std::min<std::size_t>(graph.features.size(), 1));
  return graph;
}

std::uint32_t least_points(const inputs::Graph& graph) {
  const LoneFeature feature(graph);
  std::uint32_t points = 0;
  for (Parameter at = feature.furthest_from(0); at != parameter_end;
       at = feature.furthest_from(at)) {
    ++points;
  }
  return points;
}

LoneResult measure_lone(std::size_t nodes, std::uint64_t seed) {
  const inputs::Graph graph = lone_graph(nodes, seed);
  LoneResult result{.nodes = nodes, .seed = seed, .least = least_points(graph), .added = {}};
  for (const System& system : lone_systems()) {
    const Attempt attempt = system.run(graph, Depth::whole);
    result.added.push_back(attempt.verdict == Verdict::ok ? attempt.added : lone_failed);
  }
  return result;
}

}  // namespace etcm::compare
