// Graphs small enough to be worked out by hand.
#pragma once

#include <vector>

#include "compare/systems/attempt.h"
#include "inputs/graph.h"

namespace etcm::compare {

// The feature from (0, 0) to (1000, 0), and nodes beside it.
//
// A gate at x is a node above and one below, whose heights multiply to P. A circle through both and
// through a place at distance d from the gate on the feature leaves the feature again P / d beyond
// the gate (power of the point where the gate crosses the feature).
inline inputs::Graph one_feature(std::vector<Position> beside) {
  inputs::Graph graph{"one", {{0, 0}, {1000, 0}}, {inputs::between_nodes(0, 1)}};
  graph.nodes.insert(graph.nodes.end(), beside.begin(), beside.end());
  return graph;
}

inline std::vector<Point> added_points(const Attempt& attempt) {
  std::vector<Point> points;
  for (const files::ImageVertex& vertex : attempt.image.vertices) {
    if (vertex.is_steiner) points.push_back(vertex.point);
  }
  return points;
}

// In the user's unit.
inline double units(std::int64_t subunits) {
  return static_cast<double>(subunits) / static_cast<double>(subunits_per_unit);
}

// A step of the grid of a feature 1000 long, and rounding to it.
inline constexpr double one_step = 1e-5;

}  // namespace etcm::compare
