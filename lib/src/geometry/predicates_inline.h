// The predicates' filtered fast path, for the library's own loops: the answer is the same as that
// of the public functions, without a call in the common case.
//
// The filters compute the determinant in double with a bound on its error; a value beyond the bound
// has the right sign. Let u = 2^-53. Coordinates are integers of at most 2^52, so differences are
// taken in integers, are at most 2^53 and convert to double EXACTLY: the bounds count only the
// roundings after that, and are tighter than those for rounded differences (Shewchuk, Adaptive
// Precision Floating-Point Arithmetic, 1997, needs 3u and 10u). Nothing can overflow (values stay
// below 2^216) or underflow (every product is an integer). Where doubles are computed in software
// these filters decide nothing, and those of narrow_filter.h do.
//
// A compiler may fuse a product and the sum it goes into (-ffp-contract): that takes one of the
// roundings counted here away, and changes no other. So the bounds hold as they are, fused or not;
// the value may be another one, but only its sign beyond the bound is ever looked at.
#pragma once

#include <cmath>

#include "base/assumptions.h"
#include "etcm/predicates.h"

namespace etcm::internal {

// The exact stage, with the integers this build uses.
int orient2d_settle(const Point& a, const Point& b, const Point& c) noexcept;
// The filter, and the exact stage where it does not decide.
int incircle_settle(const Point& a, const Point& b, const Point& c, const Point& d) noexcept;

// Compilers say so of the machines that may lack them: ARM's bit 3 of __ARM_FP is double precision.
// Who wants limbs wants what goes with them.
#if defined(ETCM_FORCE_LIMBS) || (defined(__arm__) && !(defined(__ARM_FP) && (__ARM_FP & 8))) || \
    (defined(__riscv) && !(defined(__riscv_flen) && __riscv_flen >= 64))
inline constexpr bool has_double_unit = false;
// A call is nothing beside what it computes there, and spares text.
#define ETCM_IN_DOUBLES [[gnu::noinline]] inline
#else
inline constexpr bool has_double_unit = true;
#define ETCM_IN_DOUBLES inline
#endif

inline constexpr double filter_unit = 0x1p-53;

// With l and r the rounded products, |l - r| is the determinant up to u (|l| + |r|), and the last
// subtraction, being correctly rounded, keeps the sign and changes the size by a factor of at most
// 1 + u. So det decides if |det| / (1 + u) > u (|l| + |r|). Computing the right side costs two
// more roundings: u (1 + u) / (1 - u)^2 < u (1 + 8u), which is a double.
inline constexpr double orient2d_error = filter_unit * (1.0 + 8.0 * filter_unit);

// Each of the 12 monomials lift * product is rounded twice in its lift, twice in its cross product,
// once where these are multiplied, and at most once in the first of the two last additions: the
// sum before the last rounding is off by at most 6u / (1 - 6u) times the permanent (the same sum of
// magnitudes). The last addition keeps the sign, as above. The computed permanent is too small by
// at most 7 roundings, the product with the constant by one: 6u (1 + u) / ((1 - 6u) (1 - u)^8) is
// 6u (1 + 15u) to first order, below u (6 + 128u), which is a double.
inline constexpr double incircle_error = filter_unit * (6.0 + 128.0 * filter_unit);

// A coarser bound that needs no magnitudes. By Cauchy and Schwarz each magnitude is at most the
// root of the product of its two lifts, so the permanent is at most 3 h^2 with h the greatest of
// the three, and 6u times that is 18u h^2; the roundings of h^2 and of the bound stay far below u.
inline constexpr double incircle_coarse_error = filter_unit * 19.0;

// A point as seen from another: exact.
struct Offset {
  double x;
  double y;
};

inline Offset offset(const Point& p, const Point& origin) noexcept {
  return {static_cast<double>(p.x - origin.x), static_cast<double>(p.y - origin.y)};
}

inline double lift(const Offset& a) noexcept { return a.x * a.x + a.y * a.y; }

// A cross product and the sum of magnitudes that bounds its error.
struct Cross {
  double value;
  double magnitude;
  friend Cross operator-(const Cross& c) noexcept { return {-c.value, c.magnitude}; }
};

inline double cross_value(const Offset& a, const Offset& b) noexcept {
  return a.x * b.y - a.y * b.x;
}

inline Cross cross(const Offset& a, const Offset& b) noexcept {
  const double left = a.x * b.y;
  const double right = a.y * b.x;
  return {left - right, std::fabs(left) + std::fabs(right)};
}

// The sign of orient2d(a, b, origin) with ab = cross(a, b), or 0 where the double does not decide.
inline int orient2d_filter(const Cross& ab) noexcept {
  if constexpr (!has_double_unit) return 0;
  const double bound = orient2d_error * ab.magnitude;
  return (ab.value > bound) - (ab.value < -bound);
}

// The sign of incircle(a, b, c, origin), or 0 where the double does not decide.
inline int incircle_filter(double a_lift, const Cross& bc, double b_lift, const Cross& ca,
                           double c_lift, const Cross& ab) noexcept {
  if constexpr (!has_double_unit) return 0;
  const double determinant = a_lift * bc.value + b_lift * ca.value + c_lift * ab.value;
  const double permanent = a_lift * bc.magnitude + b_lift * ca.magnitude + c_lift * ab.magnitude;
  const double bound = incircle_error * permanent;
  return (determinant > bound) - (determinant < -bound);
}

// The same by the coarser bound, with the values of the cross products alone: for inner loops,
// which go on to incircle_fast().
inline int incircle_coarse(double a_lift, double bc, double b_lift, double ca, double c_lift,
                           double ab) noexcept {
  if constexpr (!has_double_unit) return 0;
  const double determinant = a_lift * bc + b_lift * ca + c_lift * ab;
  const double greater = a_lift < b_lift ? b_lift : a_lift;
  const double greatest = greater < c_lift ? c_lift : greater;
  const double bound = incircle_coarse_error * (greatest * greatest);
  return (determinant > bound) - (determinant < -bound);
}

inline int orient2d_filter(const Point& a, const Point& b, const Point& c) noexcept {
  return orient2d_filter(cross(offset(a, c), offset(b, c)));
}

inline int incircle_filter(const Point& a, const Point& b, const Point& c,
                           const Point& d) noexcept {
  const Offset ad = offset(a, d), bd = offset(b, d), cd = offset(c, d);
  return incircle_filter(lift(ad), cross(bd, cd), lift(bd), cross(cd, ad), lift(cd), cross(ad, bd));
}

// Whether p lies in the open interval from a to b, given that the three are collinear.
inline bool strictly_between(const Point& p, const Point& a, const Point& b) noexcept {
  return a < b ? a < p && p < b : b < p && p < a;
}

inline int orient2d_fast(const Point& a, const Point& b, const Point& c) noexcept {
  const int sign = orient2d_filter(a, b, c);
  return sign != 0 ? sign : orient2d_settle(a, b, c);
}

inline int incircle_fast(const Point& a, const Point& b, const Point& c, const Point& d) noexcept {
  const Offset ad = offset(a, d), bd = offset(b, d), cd = offset(c, d);
  const int sign = incircle_coarse(lift(ad), cross_value(bd, cd), lift(bd), cross_value(cd, ad),
                                   lift(cd), cross_value(ad, bd));
  return sign != 0 ? sign : incircle_settle(a, b, c, d);
}

}  // namespace etcm::internal
