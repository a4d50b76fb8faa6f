// The paper's section 4: how many points a feature needs that is alone, where nothing that is added
// breaks anything. There the least can be worked out from the nodes, without any mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "compare/systems/system.h"
#include "inputs/random_graph.h"

namespace etcm::compare {

struct LoneResult {
  std::size_t nodes = 0;
  std::uint64_t seed = 0;
  std::uint32_t least = 0;
  std::vector<std::uint32_t> added;  // in the order of lone_systems(); failed where no mesh came
};
inline constexpr std::uint32_t lone_failed = ~std::uint32_t{0};

// Those that conform, other readings included.
std::vector<System> lone_systems();

// A random graph of which only the first feature is left.
inputs::Graph lone_graph(std::size_t nodes, std::uint64_t seed);

// The fewest points on the grid that make a graph's only feature a union of Delaunay edges; no node
// may stand on its inside. A part of the feature can be an edge exactly when some circle through
// its ends has no node inside, and then so can each part of that part: so from one end, as far as
// it goes each time, is least. O(nodes * points * grid bits).
std::uint32_t least_points(const inputs::Graph& graph);

LoneResult measure_lone(std::size_t nodes, std::uint64_t seed);

}  // namespace etcm::compare
