// What the exact arithmetic takes for granted about compiler and machine, checked when compiled.
#pragma once

#include <cfloat>
#include <climits>
#include <cstdint>
#include <limits>

namespace etcm::internal {

static_assert(CHAR_BIT == 8, "limbs and storage sizes are counted in 8-bit bytes");
static_assert(sizeof(int) >= 4, "shifts of small constants are done in int");
static_assert(-1 == ~0, "signed integers are two's complement");
static_assert((std::int64_t{-3} >> 1) == -2, "right shift keeps the sign");

static_assert(std::numeric_limits<double>::is_iec559 && sizeof(double) == 8 && DBL_MANT_DIG == 53,
              "the filters' error bounds are those of IEEE 754 binary64");

// x87 keeps intermediate results in 80 bits and rounds twice: same source, other bits.
static_assert(FLT_EVAL_METHOD == 0, "double arithmetic must round to double (no x87)");

// Of -ffast-math and -Ofast, and of parts of it where a compiler says so.
#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__)
#error \
    "etcm must not be compiled with -ffast-math, -funsafe-math-optimizations, \
-fassociative-math or -freciprocal-math: the predicates would lose their proof"
#endif

}  // namespace etcm::internal
