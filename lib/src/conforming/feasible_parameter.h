// How far along a feature one end of a missing subsegment reaches: Q1 and Q2 of the paper, exactly.
#pragma once

#include "etcm/split_site.h"

namespace etcm::internal {

// The largest t in [site.head, site.tail] whose point is inside or on the circumcircle of the
// triangle head, site.head_right, site.head_left; and the smallest for the one at tail. Rounding
// towards the end is safe: the circle through that end tangent to the circumcircle there shrinks
// inside it. O(log) exact tests around a floating-point guess; the guess does not show.
Parameter feasible_from_head(const SplitSite& site) noexcept;
Parameter feasible_from_tail(const SplitSite& site) noexcept;

}  // namespace etcm::internal
