// What one feature does to a mesh: tried, not proved.
#pragma once

#include <cstdint>
#include <optional>

#include "bench/tiles/distribution.h"
#include "bench/tiles/quad_tree.h"
#include "etcm/mesh.h"
#include "inputs/graph.h"

namespace etcm::bench {

struct Changes {
  Distribution tiles;  // that have Steiner vertices which are otherwise, or an end of the feature
  Distribution spacings;  // from the feature's box to the farthest of these vertices
  std::size_t lone = 0;   // features without which all others are laid as with them
};

// Takes features out of the canonical mesh of the graph one by one, looks what is laid otherwise,
// and puts them back. Cells of the tree are the tiles.
Changes changes_without(const inputs::Graph& graph, Mesh& whole, const QuadTree& tree,
                        std::size_t samples, std::int32_t spacing, std::uint64_t seed);

// How far around a tile, in spacings, a member must know nodes and features for its part to be that
// of the one mesh: the least of some, from which on all were enough. None: the last was not.
std::optional<std::int32_t> least_knowledge(const inputs::Graph& graph, const Mesh& whole,
                                            const Square& tile, std::int32_t spacing);

}  // namespace etcm::bench
