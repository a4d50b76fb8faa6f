// The same graph, given otherwise: what the criterion of stability asks for.
#pragma once

#include <cstdint>

#include "inputs/graph.h"

namespace etcm::compare {

// The endpoints of every feature exchanged: the paper's test.
inputs::Graph exchanged(const inputs::Graph& graph);

// Nodes and features in another order.
inputs::Graph shuffled(const inputs::Graph& graph, std::uint64_t seed);

}  // namespace etcm::compare
