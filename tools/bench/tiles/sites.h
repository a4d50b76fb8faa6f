// Large sites to be cut into tiles: squares with a side of 2^24 places.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace etcm::bench {

inline constexpr int site_bits = 24;  // of a side

enum class Spread : std::uint8_t {
  even,
  towns,     // two thirds stand in a few hundred heaps, from dense to wide
  jittered,  // a grid, each node somewhere in the middle of its cell
  lattice,   // a grid: all empty circles have ties, all sides of the hull are lines of nodes
  roads,     // lines across the site, exactly straight, with nodes in equal steps
};

struct NamedSpread {
  std::string_view name;
  Spread spread;
};
inline constexpr NamedSpread spreads[] = {{"even", Spread::even},
                                          {"towns", Spread::towns},
                                          {"jittered", Spread::jittered},
                                          {"lattice", Spread::lattice},
                                          {"roads", Spread::roads}};

// Morton codes of different places, sorted; at most so many. The same on every machine.
std::vector<std::uint64_t> spread_nodes(Spread spread, std::size_t count, std::uint64_t seed);

}  // namespace etcm::bench
