// The order in which build() inserts nodes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "etcm/types.h"

namespace etcm::internal {

// The order in which build() inserts nodes: along a Hilbert curve. Lives in the part of the
// triangle memory that the growing mesh reaches last, each entry just read before it is
// overwritten.
struct OrderEntry {
  std::uint32_t key;
  std::uint32_t vertex;
};
OrderEntry* hilbert_order(std::span<const Position> nodes, std::byte* memory,
                          std::size_t bytes) noexcept;

}  // namespace etcm::internal
