// Graphs of any size on which a mesher could be slow.
#pragma once

#include <cstddef>

#include "inputs/graph.h"

namespace etcm::bench {

inline constexpr std::int32_t far_away = position_max;

// A hub, the first node, in a ring of as many.
inputs::Graph ring(std::size_t count);

// A hub, the first node, far beside a line of as many.
inputs::Graph line(std::size_t count);

// The ring, and a feature from the hub to each of it.
inputs::Graph star(std::size_t count);

// Nodes on a square grid in the order of rows, as many as make a square.
inputs::Graph grid(std::size_t count);

// One feature along a line, through all nodes but its ends.
inputs::Graph long_feature(std::size_t count);

// And two nodes beside each part of it, so that each needs a Steiner vertex.
inputs::Graph beset_feature(std::size_t count);

// Features from one side of the world to the other, 100 apart.
inputs::Graph parallels(std::size_t count);

// Nodes that stand evenly, and the first node far away from them.
inputs::Graph cluster(std::size_t count);

// Nodes that stand evenly, and short features for 15 % of them.
inputs::Graph even(std::size_t count);

// Circles beside each other, with as many nodes on each as a circle of integers has.
inputs::Graph circles(std::size_t count);

}  // namespace etcm::bench
