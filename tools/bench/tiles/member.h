// A member that keeps one tile of a site: its nodes, and a halo of cells that it widens until every
// triangle at a node of its own is final.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "bench/tiles/quad_tree.h"
#include "bench/tiles/triangle_sum.h"

namespace etcm::bench {

struct TileReport {
  TriangleSum own;        // triangles whose smallest corner is in the tile
  bool is_final = false;  // all of them, and all others at its nodes
  int meshes = 0;         // made until then, each with more nodes
  std::uint32_t own_nodes = 0;
  std::uint32_t known_nodes = 0;      // with its own
  std::uint32_t filters = 0;          // squares, no fewer would do, that are the tile and the halo
  std::vector<std::uint32_t> halo{};  // cells
};

// What a member of this tile comes to, whatever is elsewhere. It stops where `meshes_max` are made,
// final or not. `tell`, where given, hears of each triangle of its own.
TileReport keep_tile(const QuadTree& tree, const QuadTree::Branch& tile, int meshes_max = 1000,
                     const std::function<void(const Corners&)>& tell = {});

}  // namespace etcm::bench
