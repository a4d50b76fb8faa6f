// The memory of one mesh, sized at compile time: a static object or a member, never the heap.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>

#include "etcm/config.h"

namespace etcm {
inline namespace ETCM_IDS {

// Algorithms see only the bytes, so no code is instantiated for a capacity.
template <std::uint32_t VerticesMax, std::uint32_t FeaturesMax>
class MeshStorage {
  static_assert(VerticesMax >= 1 && VerticesMax <= vertices_limit);
  static_assert(FeaturesMax <= features_limit);
  static_assert(storage_bytes(VerticesMax, FeaturesMax) < std::numeric_limits<std::size_t>::max());

 public:
  [[nodiscard]] std::span<std::byte> bytes() noexcept { return bytes_; }

  // The configuration this storage has room for.
  [[nodiscard]] static constexpr MeshConfig config() noexcept {
    return {.vertices_max = VerticesMax, .features_max = FeaturesMax};
  }

 private:
  alignas(8) std::array<std::byte, storage_bytes(VerticesMax, FeaturesMax)> bytes_;
};

}  // namespace ETCM_IDS
}  // namespace etcm
