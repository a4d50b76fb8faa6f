#include "etcm/predicates.h"

#include "base/check.h"
#include "geometry/narrow_filter.h"
#include "geometry/predicates_inline.h"
#include "geometry/predicates_internal.h"

namespace etcm::internal {

int orient2d_settle(const Point& a, const Point& b, const Point& c) noexcept {
  if constexpr (!has_double_unit) {
    if (const int sign = orient2d_narrow(a, b, c); sign != undecided) return sign;
  }
  return orient2d_exact<ExactArithmetic>(a, b, c);
}

int incircle_settle(const Point& a, const Point& b, const Point& c, const Point& d) noexcept {
  if constexpr (has_double_unit) {
    if (const int sign = incircle_filter(a, b, c, d); sign != 0) return sign;
  } else {
    if (const int sign = incircle_narrow(a, b, c, d); sign != undecided) return sign;
  }
  return incircle_exact<ExactArithmetic>(a, b, c, d);
}

}  // namespace etcm::internal

namespace etcm {
inline namespace ETCM_IDS {

int orient2d(const Point& a, const Point& b, const Point& c) noexcept {
  return internal::orient2d_fast(a, b, c);
}

int incircle(const Point& a, const Point& b, const Point& c, const Point& d) noexcept {
  return internal::incircle_fast(a, b, c, d);
}

// The incircle determinant is linear in each point's lift (its height on the paraboloid), and the
// factor of a lift is, up to the sign, the orientation of the three other points. Raising the
// points by amounts that are infinitely small, and infinitely smaller for each lexicographically
// lesser point, leaves a nonzero determinant as it is; a zero one gets the sign of the first raise
// whose factor is not 0. That is always the greatest point's, since three distinct points of one
// circle are not collinear:
//   d raised: it goes above the plane of the others, which is outside, always;
//   a raised: the factor is orient2d(d, b, c), the triangle with d in the place of a;
//   b and c:  likewise, because the determinant does not change when a, b, c are rotated.
int incircle_perturbed(const Point& a, const Point& b, const Point& c, const Point& d) noexcept {
  ETCM_VERIFY_THAT(internal::orient2d_fast(a, b, c) > 0);
  ETCM_VERIFY_THAT(a != d && b != d && c != d);
  const int sign = internal::incircle_fast(a, b, c, d);
  if (sign != 0) return sign;
  if (d > a && d > b && d > c) return -1;
  if (a > b && a > c) return internal::orient2d_fast(d, b, c);
  if (b > c) return internal::orient2d_fast(a, d, c);
  return internal::orient2d_fast(a, b, d);
}

}  // namespace ETCM_IDS
}  // namespace etcm
