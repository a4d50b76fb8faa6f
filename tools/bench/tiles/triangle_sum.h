// The triangles of a mesh as a number that can be added up over tiles, and compared.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>

#include "bench/tiles/quad_tree.h"
#include "etcm/mesh.h"

namespace etcm::bench {

// In the place of the vertex at infinity: greater than any other.
inline constexpr Point beyond = {.x = std::numeric_limits<std::int64_t>::max(),
                                 .y = std::numeric_limits<std::int64_t>::max()};

// Of one triangle, counter-clockwise, the lexicographically smallest first. A ghost is one with
// `beyond` as a corner.
using Corners = std::array<Point, 3>;

// The hash is a sum over the triangles, so those of several tiles can be added up.
struct TriangleSum {
  std::uint64_t count = 0;
  std::uint64_t hash = 0;
  friend bool operator==(const TriangleSum&, const TriangleSum&) = default;

  void add(const Corners& corners) noexcept;
  void add(const TriangleSum& other) noexcept;
};

// Whether a place, of a Steiner vertex too, is in the square: each is in one of those that touch.
bool is_in(const Point& point, const Square& square) noexcept;

// Calls `visit` with each triangle, ghosts among them, whose smallest corner is in the square.
void for_each_triangle(const Mesh& mesh, const Square& square,
                       const std::function<void(const Corners&)>& visit);

TriangleSum triangles_in(const Mesh& mesh, const Square& square);

}  // namespace etcm::bench
