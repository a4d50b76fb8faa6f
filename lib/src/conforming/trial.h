// Another way to lay what some Steiner vertices stand for, kept where it needs no more of them.
#pragma once

#include <span>

#include "triangulation/change.h"

namespace etcm::internal {

// A number from 0 up to below `end`.
std::uint32_t draw(Change& change, std::uint32_t end) noexcept;

// Takes out some Steiner vertices, and lays their segments again in an order that is drawn. The
// change is of the extent `trial`, and is ended: true where the mesh has no more Steiner vertices
// than before, else it is as it was. The list of the vertices is used up.
bool try_without(Change& change, std::span<IdValue> vertices) noexcept;

}  // namespace etcm::internal
