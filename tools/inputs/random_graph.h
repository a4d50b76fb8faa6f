// The random graphs of the ETCM paper's experiment.
#pragma once

#include <cstddef>
#include <cstdint>

#include "inputs/graph.h"

namespace etcm::inputs {

// The paper does not say how long its features are, so there are two readings.
enum class FeatureLength : std::uint8_t {
  any,       // any pair of nodes that fits
  in_reach,  // pairs within four mean spacings (side / sqrt(nodes)) of each other
};

// The side of the square that random_graph() fills: 1000 up to 5000 nodes; above, it grows so that
// the density stays that of 5000 nodes.
std::int32_t random_graph_side(std::size_t nodes) noexcept;

// Uniform distinct integer nodes in [0, side]^2, in random order; features 15 % of them, which
// neither cross nor run through a node. Deterministic: the same graph for the same arguments
// everywhere. Features of any length get rare as the square fills: meant for up to 5000 nodes.
Graph random_graph(std::size_t nodes, FeatureLength length, std::uint64_t seed);

// Nodes alone.
Graph random_nodes(std::size_t nodes, std::uint64_t seed);

// A closed feature through `nodes` nodes that stand around a centre at random distances.
Graph random_polygon(std::size_t nodes, std::uint64_t seed);

// `clusters` dense heaps of nodes, joined and crossed by features of any length.
Graph random_clusters(std::size_t clusters, std::size_t nodes_each, std::uint64_t seed);

}  // namespace etcm::inputs
