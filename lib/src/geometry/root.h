// Arithmetic in double that gives the same bits whatever the compiler fuses (etcm/policy.h): for
// what is chosen by a value, where a test is decided by a sign alone.
#pragma once

#include "etcm/policy.h"
#include "geometry/predicates_inline.h"

namespace etcm::internal {

// For machines without an instruction for it.
double root_by_digits(double square) noexcept;

// Not std::sqrt: without optimisation, or where errors of it are told in errno, compilers ask the
// mathematical library, which a program may not have.
inline double root_of(double square) noexcept {
  if constexpr (!has_double_unit) return root_by_digits(square);
  double root = 0;
#if defined(__AVX__)
  asm("vsqrtsd %1, %1, %0" : "=x"(root) : "x"(square));
#elif defined(__SSE2__)
  asm("sqrtsd %1, %0" : "=x"(root) : "x"(square));
#elif defined(__aarch64__)
  asm("fsqrt %d0, %d1" : "=w"(root) : "w"(square));
#elif defined(__arm__) && defined(__ARM_FP) && (__ARM_FP & 8)
  asm("vsqrt.f64 %P0, %P1" : "=w"(root) : "w"(square));
#elif defined(__riscv_flen) && __riscv_flen >= 64
  asm("fsqrt.d %0, %1" : "=f"(root) : "f"(square));
#else
  root = root_by_digits(square);
#endif
  return root;
}

ETCM_IN_DOUBLES double rounded_lift(const Offset& a) noexcept {
  return product(a.x, a.x) + product(a.y, a.y);
}

ETCM_IN_DOUBLES double rounded_dot(const Offset& a, const Offset& b) noexcept {
  return product(a.x, b.x) + product(a.y, b.y);
}

ETCM_IN_DOUBLES double rounded_cross(const Offset& a, const Offset& b) noexcept {
  return product(a.x, b.y) - product(a.y, b.x);
}

// Where the circle through the origin, b and c has its centre, given half of one over their cross
// product.
inline Offset circle_centre(const Offset& b, const Offset& c, double half) noexcept {
  const double bb = rounded_lift(b), cc = rounded_lift(c);
  return {product(product(bb, c.y) - product(cc, b.y), half),
          product(product(cc, b.x) - product(bb, c.x), half)};
}

}  // namespace etcm::internal
