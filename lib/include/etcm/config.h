// What the caller decides once: capacities, budgets, the split policy.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "etcm/policy.h"
#include "etcm/status.h"
#include "etcm/types.h"

namespace etcm {
inline namespace ETCM_IDS {

struct MeshConfig {
  // Nodes and Steiner vertices together. At least 1; at most vertices_limit.
  std::uint32_t vertices_max = 0;
  // One place for each segment of a feature between neighbouring nodes on it: a feature that runs
  // through two further nodes takes three. At most features_limit; 0 for a plain Delaunay mesh.
  std::uint32_t features_max = 0;
  // Most Steiner vertices the mesh may hold. 0: as many as vertices_max leaves room for.
  std::uint32_t steiner_max = 0;
  SplitPolicy policy = split_default;
};

// Ids carry two bits of bookkeeping beside the index; these are what is left.
inline constexpr std::uint32_t vertices_limit = sizeof(IdValue) == 2 ? 4094u : (1u << 28) - 2u;
inline constexpr std::uint32_t features_limit = sizeof(IdValue) == 2 ? 8190u : (1u << 28) - 2u;

// ok, bad_config: also where the memory needed is more than a std::size_t can tell.
Status validate(const MeshConfig& config) noexcept;

// Bytes of one vertex (with its two triangles), of one feature segment, and of the fixed head.
// Checked against the real layout when the library is compiled.
inline constexpr std::size_t bytes_per_vertex_capacity = 16 + 14 * sizeof(IdValue);
inline constexpr std::size_t bytes_per_feature_capacity = 12 * sizeof(IdValue);
inline constexpr std::size_t bytes_fixed = 768;

// The grid of hints for locate: 4^n cells, at most one for four vertices.
[[nodiscard]] constexpr int hint_side_bits(std::uint32_t vertices_max) noexcept {
  int bits = 0;
  while ((std::uint64_t{16} << (2 * bits)) <= vertices_max) ++bits;
  return bits;
}

// The memory Mesh::open needs for this configuration, all in, as a Size of this machine or of
// another. Where that is more than a Size can tell, the greatest there is: storage of that length
// there is none, so too little memory is never taken for enough.
template <class Size>
[[nodiscard]] constexpr Size storage_bytes_as(std::uint32_t vertices_max,
                                              std::uint32_t features_max) noexcept {
  // Below 2^40, whatever the capacities.
  const std::uint64_t bytes =
      bytes_fixed + std::uint64_t{bytes_per_vertex_capacity} * vertices_max +
      std::uint64_t{bytes_per_feature_capacity} * features_max +
      (std::uint64_t{sizeof(IdValue)} << (2 * hint_side_bits(vertices_max)));
  constexpr Size most = std::numeric_limits<Size>::max();
  return bytes < most ? static_cast<Size>(bytes) : most;
}

// The same as a std::size_t.
[[nodiscard]] constexpr std::size_t storage_bytes(std::uint32_t vertices_max,
                                                  std::uint32_t features_max) noexcept {
  return storage_bytes_as<std::size_t>(vertices_max, features_max);
}
[[nodiscard]] constexpr std::size_t storage_bytes(const MeshConfig& config) noexcept {
  return storage_bytes(config.vertices_max, config.features_max);
}

}  // namespace ETCM_IDS
}  // namespace etcm
