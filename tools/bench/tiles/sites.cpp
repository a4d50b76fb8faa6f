#include "bench/tiles/sites.h"

#include <algorithm>
#include <cmath>

#include "bench/tiles/quad_tree.h"
#include "inputs/random.h"

namespace etcm::bench {

namespace {

constexpr std::int32_t side = std::int32_t{1} << site_bits;

using Codes = std::vector<std::uint64_t>;

Position anywhere(inputs::Random& random) {
  const std::int32_t x = random.between(0, side - 1);
  return {.x = x, .y = random.between(0, side - 1)};
}

bool is_on_site(Position place) {
  return place.x >= 0 && place.x < side && place.y >= 0 && place.y < side;
}

// Denser towards the middle: the mean of three even ones.
std::int32_t around(std::int32_t middle, std::int32_t reach, inputs::Random& random) {
  std::int32_t sum = 0;
  for (int i = 0; i < 3; ++i) sum += random.between(-reach, reach);
  return middle + sum / 3;
}

Codes even_nodes(std::size_t count, inputs::Random random) {
  Codes codes;
  for (std::size_t i = 0; i < count; ++i) codes.push_back(morton_code(anywhere(random)));
  return codes;
}

Codes town_nodes(std::size_t count, inputs::Random random) {
  struct Town {
    Position middle;
    std::int32_t reach;
  };
  std::vector<Town> towns;
  for (int i = 0; i < 300; ++i) {
    const Position middle = anywhere(random);
    towns.push_back({.middle = middle, .reach = side >> (3 + random.below(5))});
  }
  Codes codes;
  for (std::size_t i = 0; i < count; ++i) {
    Position place = anywhere(random);
    if (random.below(3) != 0) {
      const Town& town = towns[random.index(towns.size())];
      const std::int32_t x = around(town.middle.x, town.reach, random);
      const Position near{.x = x, .y = around(town.middle.y, town.reach, random)};
      if (is_on_site(near)) place = near;
    }
    codes.push_back(morton_code(place));
  }
  return codes;
}

Codes grid_nodes(std::size_t count, bool is_jittered, inputs::Random random) {
  const auto columns = static_cast<std::int32_t>(std::sqrt(static_cast<double>(count)));
  const std::int32_t step = side / std::max(1, columns);
  Codes codes;
  for (std::int32_t i = 0; i < columns; ++i) {
    for (std::int32_t j = 0; j < columns; ++j) {
      Position place{.x = i * step, .y = j * step};
      if (is_jittered) {
        place.x += random.between(step / 4, step / 2 + step / 4);
        place.y += random.between(step / 4, step / 2 + step / 4);
      }
      codes.push_back(morton_code(place));
    }
  }
  return codes;
}

Codes road_nodes(std::size_t count, inputs::Random random) {
  // As many on a road as there are roads beside each other in a square of 4 times their distance.
  const double each = 4 * std::sqrt(static_cast<double>(count));
  const auto step = static_cast<std::int32_t>(std::max(2.0, side / each));
  Codes codes;
  while (codes.size() < count) {
    const Position middle = anywhere(random);
    const std::int32_t x = random.between(-step, step), y = random.between(-step, step);
    if (x == 0 && y == 0) continue;
    for (const int way : {-1, 1}) {
      Position place = middle;
      while (is_on_site(place) && codes.size() < count) {
        codes.push_back(morton_code(place));
        place = {.x = place.x + way * x, .y = place.y + way * y};
      }
    }
  }
  return codes;
}

}  // namespace

std::vector<std::uint64_t> spread_nodes(Spread spread, std::size_t count, std::uint64_t seed) {
  const inputs::Random random(seed);
  Codes codes;
  switch (spread) {
    case Spread::even:
      codes = even_nodes(count, random);
      break;
    case Spread::towns:
      codes = town_nodes(count, random);
      break;
    case Spread::jittered:
      codes = grid_nodes(count, true, random);
      break;
    case Spread::lattice:
      codes = grid_nodes(count, false, random);
      break;
    case Spread::roads:
      codes = road_nodes(count, random);
      break;
  }
  std::sort(codes.begin(), codes.end());
  codes.erase(std::unique(codes.begin(), codes.end()), codes.end());
  return codes;
}

}  // namespace etcm::bench
