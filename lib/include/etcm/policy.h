// Where to split a segment of a feature that is not yet a mesh edge: the one decision of ETCM
// (paper, section 3) that is a choice, so it is a function to swap.
#pragma once

#include <cstdint>

#include "etcm/types.h"

namespace etcm {
inline namespace ETCM_IDS {

// The grid of one feature segment between two neighbouring nodes P < Q (lexicographic): the point
// of parameter t stands at P * 2^28 + t * (Q - P), with P and Q in user units and t in
// [0, subunits_per_unit]. It has integer sub-units AND lies exactly on the line.
using Parameter = std::int32_t;
inline constexpr Parameter parameter_end = Parameter{1} << subunit_bits;

struct SplitSite;  // a missing subsegment and its surroundings; see split_site.h

// Returns the parameter at which to split; must be in (head, tail), and in the feasible set
// (head, q1] or [q2, tail) if the call is to make progress with every split.
// Same site, same answer: a policy has no memory.
using SplitPolicy = Parameter (*)(const SplitSite& site) noexcept;

// The split rule of the paper (Algorithm 2, with the remainder as the algorithm has it): the longer
// of the two feasible ends is finished; where they overlap, the middle of the overlap. Only the
// rule: build() still takes features in its own order and prunes, which the paper does not. The
// paper's algorithm word for word is in tools/compare.
[[nodiscard]] Parameter split_paper(const SplitSite& site) noexcept;

// The rule that needs the fewest Steiner vertices over everything measured;
// lib/docs/split-policy.md has the table. Ends on every legal input.
[[nodiscard]] Parameter split_default(const SplitSite& site) noexcept;

}  // namespace ETCM_IDS
}  // namespace etcm
