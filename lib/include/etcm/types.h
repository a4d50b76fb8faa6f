// The vocabulary of the library: coordinates and ids.
#pragma once

#include <compare>
#include <cstdint>
#include <limits>

#include "etcm/id_width.h"

namespace etcm {
inline namespace ETCM_IDS {

// A place in the user's unit (a metre, a millimetre: the library does not care). Nodes stand on
// these. Legal while |x| and |y| are at most position_max.
struct Position {
  std::int32_t x = 0;
  std::int32_t y = 0;
  friend constexpr bool operator==(const Position&, const Position&) = default;
};

inline constexpr std::int32_t position_max = std::int32_t{1} << 24;

[[nodiscard]] constexpr bool in_range(Position p) noexcept {
  return p.x >= -position_max && p.x <= position_max && p.y >= -position_max && p.y <= position_max;
}

// The internal grid is 2^28 times finer. A coordinate then is at most 2^52 in magnitude and a
// difference at most 2^53, so both are exact in a double; and every Steiner vertex can stand
// exactly on its feature (see policy.h).
inline constexpr int subunit_bits = 28;
inline constexpr std::int64_t subunits_per_unit = std::int64_t{1} << subunit_bits;

// A place in sub-units, 2^-28 of the user's unit. Legal while in_range(); a call that takes others
// says so.
struct Point {
  std::int64_t x = 0;
  std::int64_t y = 0;
  // Lexicographic: by x, then by y. The symbolic perturbation and every canonical order use it.
  friend constexpr auto operator<=>(const Point&, const Point&) = default;
};

[[nodiscard]] constexpr Point to_point(Position p) noexcept {
  return {p.x * subunits_per_unit, p.y * subunits_per_unit};
}

// Whether a mesh can hold it: |x| and |y| are at most 2^52.
[[nodiscard]] constexpr bool in_range(const Point& p) noexcept {
  constexpr std::int64_t most = position_max * subunits_per_unit;
  return p.x >= -most && p.x <= most && p.y >= -most && p.y <= most;
}

// Ids are indices that keep what they name apart. They are 32 bits wide, or 16 where the build
// asks for it (CMake: ETCM_ID_BITS=16), which nearly halves the memory and holds up to 4094
// vertices.
#if ETCM_ID_BITS == 16
using IdValue = std::uint16_t;
#else
using IdValue = std::uint32_t;
#endif

template <class Tag>
struct Id {
  static constexpr IdValue none_value = std::numeric_limits<IdValue>::max();
  IdValue value = none_value;

  constexpr Id() noexcept = default;
  constexpr explicit Id(IdValue v) noexcept : value(v) {}
  [[nodiscard]] static constexpr Id none() noexcept { return Id{}; }
  [[nodiscard]] constexpr bool is_none() const noexcept { return value == none_value; }
  friend constexpr auto operator<=>(const Id&, const Id&) = default;
};

// Vertex 0 is the symbolic vertex at infinity: the triangles that have it as a corner are ghosts,
// one behind each hull edge. Nodes and Steiner vertices share the ids from 1 up.
using VertexId = Id<struct VertexTag>;
inline constexpr VertexId infinite_vertex{0};

// Triangles are dense: 0 .. triangle_count() - 1, ghosts among them. An id lasts until the next
// call that changes the mesh, or would have and was refused.
using TriangleId = Id<struct TriangleTag>;

// A constraint line between two nodes, as the user gave it. Lasts until it is removed.
using FeatureId = Id<struct FeatureTag>;

}  // namespace ETCM_IDS
}  // namespace etcm
