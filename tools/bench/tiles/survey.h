// All tiles of a site, each kept by a member of its own, beside the one mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "bench/tiles/distribution.h"
#include "bench/tiles/quad_tree.h"
#include "bench/tiles/triangle_sum.h"

namespace etcm::bench {

struct Survey {
  std::vector<std::uint32_t> tiles;                 // branches of the tree
  std::vector<std::vector<std::uint32_t>> knowers;  // of each cell: tiles, by their place above
  TriangleSum sum;                                  // of all tiles
  double seconds = 0;                               // of the processor, for all tiles
  // Of each tile that has nodes:
  Distribution halo_percent;  // nodes known beside its own, of its own
  Distribution filters;       // squares that the member subscribes to, its own among them
  Distribution sources;       // other tiles that it hears from
  Distribution meshes;        // made until all was final
};

// Tiles of at most `nodes_max` nodes.
Survey survey_tiles(const QuadTree& tree, std::uint32_t nodes_max);

// Of the processor, for this program: what else runs on the machine is not in it.
double processor_seconds();

// Of the nodes of the tree in one mesh. Throws std::runtime_error where there is no room.
TriangleSum one_mesh(const QuadTree& tree);

// How many members hear of a move: each that knows the cell where the node was, or the one where it
// is. Without any moves nothing is counted. Short steps: up to twice the mean distance of nodes in
// its cell, at each axis.
struct Hearing {
  Distribution of_step;
  Distribution of_jump;    // to anywhere
  Distribution asked;      // cells that a tile comes to lack, for each of its nodes that has moved
  std::size_t halo_cells;  // of the tiles that were asked, in the mean
};
Hearing hear_moves(const QuadTree& tree, const Survey& survey, std::size_t moves,
                   std::uint64_t seed);

}  // namespace etcm::bench
