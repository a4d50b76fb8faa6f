// Meshes to measure calls on, each told by a number alone, so that the worst ones can be kept.
#pragma once

#include <array>
#include <cstdint>

#include "etcm/mesh.h"
#include "inputs/random.h"

namespace etcm::test {

inline constexpr std::uint32_t cost_node_count = 200;
inline constexpr std::uint32_t cost_feature_count = 20;

struct CostInput {
  std::array<Position, cost_node_count> nodes;
  std::int32_t side = 0;
};

// Of these kinds only the first is what a site is like.
inline constexpr std::uint32_t cost_kinds = 6;
inline constexpr std::uint32_t cost_sizes = 4;

// Kind seed % cost_kinds, and for all but the first, one of four sizes.
void make_cost_input(std::uint32_t seed, inputs::Random& random, CostInput& input) noexcept;

}  // namespace etcm::test
