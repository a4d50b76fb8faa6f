// What the caller decides once: capacities, budgets, the split policy.
#pragma once

#include <bit>
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
  // What the policy finds in its site, for one with parameters; the library never looks into it.
  // What answers depend on must stay as it is while the mesh is open: same site, same answer.
  void* policy_context = nullptr;
};

// Ids carry two bits of bookkeeping beside the index; these are what is left.
inline constexpr std::uint32_t vertices_limit = sizeof(IdValue) == 2 ? 4094u : (1u << 28) - 2u;
inline constexpr std::uint32_t features_limit = sizeof(IdValue) == 2 ? 8190u : (1u << 28) - 2u;

// ok, bad_config: also where there is no policy, or the memory needed is more than a std::size_t
// can tell.
Status validate(const MeshConfig& config) noexcept;

// Capacities that are enough, as a rule, for so many nodes that stand about evenly and so many
// features of any length between them, for changes as well: as many Steiner vertices a feature as
// the number of nodes has binary digits, the most that was measured, and as many again, because a
// change has the old and the new ones at once; and two segments. Short features need less. Where
// nodes crowd along features it may take more: then a call answers out_of_vertices or
// out_of_features.
[[nodiscard]] constexpr MeshConfig capacity_for(std::uint32_t nodes,
                                                std::uint32_t features) noexcept {
  const auto digits = static_cast<std::uint64_t>(std::bit_width(nodes));
  const std::uint64_t vertices = nodes + 2 * digits * features;
  const std::uint64_t segments = 2 * std::uint64_t{features};
  MeshConfig config;
  config.vertices_max =
      vertices < vertices_limit ? static_cast<std::uint32_t>(vertices) : vertices_limit;
  config.features_max =
      segments < features_limit ? static_cast<std::uint32_t>(segments) : features_limit;
  return config;
}

// Bytes of one vertex (with its two triangles), of one feature segment, and of the fixed head.
// Checked against the real layout when the library is compiled.
inline constexpr std::size_t bytes_per_vertex_capacity = 16 + 14 * sizeof(IdValue);
inline constexpr std::size_t bytes_per_feature_capacity = 12 * sizeof(IdValue);
inline constexpr std::size_t bytes_fixed = 768;
// Of those the head proper, as large on every machine; a MeshReader (storage.h) has one of its own.
inline constexpr std::size_t bytes_head = 744;

// The grid of hints for locate: 4^n cells, at most one for four vertices.
[[nodiscard]] constexpr int hint_side_bits(std::uint32_t vertices_max) noexcept {
  int bits = 0;
  while ((std::uint64_t{16} << (2 * bits)) <= vertices_max) ++bits;
  return bits;
}

// The memory that a mesh takes where an id has so many bytes, 2 or 4. Below 2^40, whatever the
// capacities.
[[nodiscard]] constexpr std::uint64_t storage_bytes_with(std::uint32_t id_bytes,
                                                         std::uint32_t vertices_max,
                                                         std::uint32_t features_max) noexcept {
  return bytes_fixed + (16 + 14 * std::uint64_t{id_bytes}) * vertices_max +
         12 * std::uint64_t{id_bytes} * features_max +
         (std::uint64_t{id_bytes} << (2 * hint_side_bits(vertices_max)));
}

// The memory Mesh::open needs for this configuration, all in, as a Size of this machine or of
// another. Where that is more than a Size can tell, the greatest there is: storage of that length
// there is none, so too little memory is never taken for enough.
template <class Size>
[[nodiscard]] constexpr Size storage_bytes_as(std::uint32_t vertices_max,
                                              std::uint32_t features_max) noexcept {
  const std::uint64_t bytes = storage_bytes_with(sizeof(IdValue), vertices_max, features_max);
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

// The most that Mesh::save() writes of a mesh of these capacities, for a buffer that is an array.
// For what a std::size_t cannot tell, the greatest there is.
[[nodiscard]] constexpr std::size_t saved_bytes_most(std::uint32_t vertices_max,
                                                     std::uint32_t features_max) noexcept {
  const std::uint64_t bytes =
      48 + 8 * std::uint64_t{vertices_max} + 16 * std::uint64_t{features_max};
  constexpr std::size_t most = std::numeric_limits<std::size_t>::max();
  return bytes < most ? static_cast<std::size_t>(bytes) : most;
}

}  // namespace ETCM_IDS
}  // namespace etcm
