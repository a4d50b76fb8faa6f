#include "cost_inputs.h"

namespace etcm::test {
namespace {

using inputs::Random;

enum class Kind : std::uint8_t { spread, clusters, grid, rows, circle, line };

Position anywhere(Random& random, std::int32_t side) noexcept {
  const std::int32_t x = random.between(0, side);
  return {x, random.between(0, side)};
}

// The i-th of as many points around a circle: eight equal parts, each a chord cut evenly and pushed
// out, which is as near to a circle as integers of this size need be.
Position on_circle(std::uint32_t i, std::int32_t radius) noexcept {
  constexpr std::int32_t part = static_cast<std::int32_t>(cost_node_count / 4);
  const auto along = static_cast<std::int32_t>(i) % part;
  const std::int64_t u = 2 * along - part;
  // The rational points of a quarter of the circle.
  const std::int64_t square = std::int64_t{part} * part + u * u;
  const auto x = static_cast<std::int32_t>(radius * (2 * u * part) / square);
  const auto y = static_cast<std::int32_t>(radius * (std::int64_t{part} * part - u * u) / square);
  const std::uint32_t quarter = i / static_cast<std::uint32_t>(part) % 4;
  if (quarter == 0) return {x, y};
  if (quarter == 1) return {y, -x};
  if (quarter == 2) return {-x, -y};
  return {-y, x};
}

Position place(Kind kind, std::uint32_t i, std::int32_t side, Random& random) noexcept {
  const auto n = static_cast<std::int32_t>(i);
  switch (kind) {
    case Kind::spread:
      return anywhere(random, side);
    case Kind::clusters: {
      const Position at = anywhere(random, side / 400);
      return {at.x + n % 5 * (side / 5), at.y + n * 7 % 5 * (side / 5)};
    }
    case Kind::grid:
      return {n % 14 * (side / 14), n / 14 * (side / 14)};
    case Kind::rows:
      return {n / 2 * (side / 100) + random.between(0, 1), n % 2 * side + random.between(0, 1)};
    case Kind::circle:
      return on_circle(i, side);
    case Kind::line:
      return {n * (side / 200) + random.between(0, 1), random.between(-2, 2)};
  }
  return {};
}

bool is_taken(const CostInput& input, std::uint32_t count) noexcept {
  for (std::uint32_t i = 0; i < count; ++i) {
    if (input.nodes[i] == input.nodes[count]) return true;
  }
  return false;
}

}  // namespace

void make_cost_input(std::uint32_t seed, Random& random, CostInput& input) noexcept {
  const auto kind = static_cast<Kind>(seed % cost_kinds);
  const std::uint32_t size = seed / cost_kinds % cost_sizes;
  input.side = kind == Kind::spread ? 20'000 : std::int32_t{2000} << (4 * size);
  if (input.side > position_max / 2) input.side = position_max / 2;
  for (std::uint32_t i = 0; i < cost_node_count; ++i) {
    input.nodes[i] = place(kind, i, input.side, random);
    while (is_taken(input, i)) input.nodes[i] = anywhere(random, input.side);
  }
}

}  // namespace etcm::test
