// Another way to lay what some Steiner vertices stand for, kept where it needs no more of them.
#pragma once

#include <span>

#include "etcm/split_site.h"
#include "triangulation/change.h"

namespace etcm::internal {

inline constexpr unsigned trial_most = 16;

// A number from 0 up to below `end`.
std::uint32_t draw(Change& change, std::uint32_t end) noexcept;

// Where a trial splits: mostly where the policy would, at t.
Parameter stray(Change& change, const SplitSite& site, Parameter t) noexcept;

// Takes out some Steiner vertices, at most trial_most of them, and lays their segments again in an
// order that is drawn. The change is of the extent `trial`, and is ended: true where the mesh has
// no more Steiner vertices than before, else it is as it was.
bool try_without(Change& change, std::span<const VertexId> vertices) noexcept;

}  // namespace etcm::internal
