// How save() writes a mesh: words with the least byte first. Whoever changes it counts the version
// up and goes on reading all before: Mesh::save() promises it.
//
//   head      "etcmsave", version; ends of the vertex and segment ids; how many nodes, Steiner
//             vertices and features; the hash of the mesh
//   vertices  two words for each id from 1 on: a node's x and y, each with `bias`; a Steiner
//             vertex's segment with steiner_bit, and parameter; or nobody
//   segments  four words for each id: ends, the next segment of the feature, and its first one with
//             saved_reversed_bit; or nobody
//   tail      a checksum of all that
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "etcm/config.h"
#include "etcm/types.h"

namespace etcm::internal {

inline constexpr std::uint64_t saved_magic = 0x6576'6173'6d63'7465;
inline constexpr std::uint32_t saved_version = 1;
inline constexpr std::uint32_t saved_nobody = 0xffff'ffff;
inline constexpr std::uint32_t saved_none = 0xffff'ffff;
inline constexpr std::uint32_t steiner_bit = 0x8000'0000;
inline constexpr std::uint32_t saved_reversed_bit = 0x8000'0000;
inline constexpr std::uint32_t bias = position_max;

inline constexpr std::size_t saved_head_bytes = 40;
inline constexpr std::size_t saved_vertex_bytes = 8;
inline constexpr std::size_t saved_segment_bytes = 16;
inline constexpr std::size_t saved_tail_bytes = 8;

// More than a machine of 32 bits can have in its memory, at the most.
constexpr std::uint64_t saved_size(std::uint32_t vertex_end, std::uint32_t segment_end) noexcept {
  return saved_head_bytes + saved_vertex_bytes * (std::uint64_t{vertex_end} - 1) +
         saved_segment_bytes * std::uint64_t{segment_end} + saved_tail_bytes;
}

static_assert(saved_size(201, 20) == saved_bytes_most(200, 20));

struct SavedHead {
  std::uint64_t magic = saved_magic;
  std::uint32_t version = saved_version;
  std::uint32_t vertex_end = 0;
  std::uint32_t segment_end = 0;
  std::uint32_t node_count = 0;
  std::uint32_t steiner_count = 0;
  std::uint32_t feature_count = 0;
  std::uint64_t hash = 0;
};

}  // namespace etcm::internal
