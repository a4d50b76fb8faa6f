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

// Returns the parameter at which to split: in (head, tail), another is a programming error
// (Fault::outside); and in the feasible set (head, q1] or [q2, tail) if the call is to make
// progress with every split. A policy that makes none uses up vertices, budget or work.
//
// Same site, same answer: a policy has no memory. It may read the vertices and triangles of
// site.mesh, a triangulation that stands: kind(), point(), neighbours(), triangle(), locate(),
// nearest_node(). Not all features are in it yet, so chain(), hash(), features_at() and audit() say
// nothing that holds. To change the mesh is a programming error. A policy may kick a watchdog, but
// for that there is Mesh::keep_alive().
using SplitPolicy = Parameter (*)(const SplitSite& site) noexcept;

// The split rule of the paper (Algorithm 2, with the remainder as the algorithm has it): the longer
// of the two feasible ends is finished; where they overlap, the middle of the overlap. Only the
// rule: build() still takes features in its own order and prunes, which the paper does not. The
// paper's algorithm word for word is in tools/compare.
[[nodiscard]] Parameter split_paper(const SplitSite& site) noexcept;

// The rule that needs the fewest Steiner vertices over everything measured;
// docs/split-policy.md has the table. Ends on every legal input.
[[nodiscard]] Parameter split_default(const SplitSite& site) noexcept;

// For policies that compute: + - and / give the same bits on every machine, and so does a product,
// unless a compiler fuses it with a sum, which rounds once where the source rounds twice. Not this
// one, whatever the flags (-ffp-contract).
[[nodiscard]] inline double product(double a, double b) noexcept {
  double rounded = a * b;
  // Nothing is done; but the compiler does not know that, so it no longer sees a product.
#if defined(__FMA__) || defined(__FMA4__)
  asm("" : "+x"(rounded));
#elif defined(__aarch64__) || (defined(__arm__) && defined(__ARM_FP) && (__ARM_FP & 8))
  asm("" : "+w"(rounded));
#elif !defined(__x86_64__) && !defined(__i386__) && !defined(__arm__)
  asm("" : "+m"(rounded));
#endif
  return rounded;
}

// The square root of 0, or of a normal number above, correctly rounded; without a mathematical
// library. Below 700 instructions on a Cortex-M4.
[[nodiscard]] double root(double square) noexcept;

}  // namespace ETCM_IDS
}  // namespace etcm
