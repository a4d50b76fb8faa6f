// Graphs that are hard on purpose: each makes one weakness of a conforming mesher show.
#pragma once

#include <cstddef>
#include <cstdint>

#include "inputs/graph.h"

namespace etcm::inputs {

// Features from one node, `step_millidegrees` apart, with lengths drawn from [shortest, longest].
struct Fan {
  std::size_t features;
  std::int32_t step_millidegrees;
  std::int32_t shortest;
  std::int32_t longest;
  std::uint64_t seed = 1;
};
Graph fan(const Fan& shape);

// Parallel upright features `spacing` apart; every second one stands `stagger` higher.
Graph comb(std::size_t teeth, std::int32_t spacing, std::int32_t length, std::int32_t stagger);

// Level features `apart` from each other, and `around` nodes scattered on both sides of them.
Graph parallels(std::size_t features, std::int32_t apart, std::int32_t length, std::size_t around,
                std::uint64_t seed);

enum class GridFeatures : std::uint8_t {
  cell_diagonals,   // one in each cell, either way: cocircular ties that need no Steiner vertex
  long_diagonals,   // from side to side through many nodes
  knight_moves,     // two cells by one: crossed by edges of the grid
  random_segments,  // any pair that fits
};
// side * side nodes, `spacing` apart, all cells cocircular.
Graph grid(std::size_t side, std::int32_t spacing, GridFeatures features, std::uint64_t seed);

// A chain of nodes that winds around the origin, `millidegrees` on and `outwards` away each time.
Graph spiral(std::size_t nodes, std::int32_t millidegrees, std::int32_t outwards);

// Nodes 1000 apart that leave a line by at most `deviation`, with features of up to `reach` steps.
Graph nearly_collinear(std::size_t nodes, std::int32_t deviation, std::size_t reach,
                       std::uint64_t seed);

// Nodes rounded to integers off a circle, and chords of it that do not cross.
Graph circle(std::size_t nodes, std::int32_t radius, std::size_t chords, std::uint64_t seed);

// All 324 integer nodes of x^2 + y^2 = 32045^2, exactly on one circle, and chords that do not
// cross: every one is an edge of some Delaunay mesh, so none needs a Steiner vertex.
Graph exact_circle(std::size_t chords, std::uint64_t seed);

// A closed feature that goes in and out between two radii.
Graph star(std::size_t points, std::int32_t inner, std::int32_t outer);

// Two rails, rungs between them that lean by `lean`.
Graph ladder(std::size_t rungs, std::int32_t spacing, std::int32_t width, std::int32_t lean);

// Squares around one centre, each `step` larger and turned by `turn_millidegrees`.
Graph nested_squares(std::size_t squares, std::int32_t step, std::int32_t turn_millidegrees);

// Features in pairs that meet at `millidegrees`, as long as the range allows, on a common chain.
Graph zigzag(std::size_t features, std::int32_t millidegrees, std::int32_t length);

// Nodes on one line, and a feature through every `through` of them.
Graph collinear(std::size_t nodes, std::size_t through);

}  // namespace etcm::inputs
