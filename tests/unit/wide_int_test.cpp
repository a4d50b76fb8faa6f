// Both integer arithmetics against GMP, on values at and near every edge of their range.
#include "geometry/wide_int.h"

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <vector>

#include "support/big_integer.h"

namespace {

using etcm::internal::LimbArithmetic;

mpz_class to_big(std::int64_t value) { return etcm::test::integer(value); }

// The value modulo 2^bits, in [-2^(bits - 1), 2^(bits - 1)).
mpz_class wrap(const mpz_class& value, unsigned bits) {
  mpz_class result;
  mpz_fdiv_r_2exp(result.get_mpz_t(), value.get_mpz_t(), bits);
  if (mpz_tstbit(result.get_mpz_t(), bits - 1) != 0) result -= mpz_class(1) << bits;
  return result;
}

template <std::size_t Count>
mpz_class to_big(const etcm::internal::Limbs<Count>& value) {
  mpz_class result;
  mpz_import(result.get_mpz_t(), Count, -1, sizeof(std::uint32_t), 0, 0, value.limb.data());
  return wrap(result, 32 * Count);
}

#ifdef __SIZEOF_INT128__
using etcm::internal::NativeArithmetic;

mpz_class to_big(const NativeArithmetic::Int128& value) {
  mpz_class result;
  mpz_import(result.get_mpz_t(), 1, -1, sizeof value, 0, 0, &value);
  return wrap(result, 128);
}

mpz_class to_big(const NativeArithmetic::Int256& value) {
  mpz_class high, low;
  mpz_import(high.get_mpz_t(), 1, -1, sizeof value.high, 0, 0, &value.high);
  mpz_import(low.get_mpz_t(), 1, -1, sizeof value.low, 0, 0, &value.low);
  return wrap((high << 128) + low, 256);
}
#endif

std::vector<std::int64_t> edge_values() {
  std::vector<std::int64_t> values{0, INT64_MIN, INT64_MAX};
  for (int shift = 0; shift < 63; ++shift) {
    for (const std::int64_t step : {-1, 0, 1}) {
      values.push_back((std::int64_t{1} << shift) + step);
      values.push_back(-(std::int64_t{1} << shift) + step);
    }
  }
  std::mt19937_64 random(20150720);
  for (int i = 0; i < 100; ++i) values.push_back(static_cast<std::int64_t>(random()));
  return values;
}

template <class Arithmetic>
class WideInt : public testing::Test {};

#ifdef __SIZEOF_INT128__
using Arithmetics = testing::Types<NativeArithmetic, LimbArithmetic>;
#else
using Arithmetics = testing::Types<LimbArithmetic>;
#endif
TYPED_TEST_SUITE(WideInt, Arithmetics);

TYPED_TEST(WideInt, ProductOf64BitsIsExactIn128) {
  const auto values = edge_values();
  for (const std::int64_t a : values) {
    for (const std::int64_t b : values) {
      const auto product = TypeParam::product(a, b);
      const mpz_class expected = to_big(a) * to_big(b);
      ASSERT_EQ(to_big(product), expected) << a << " * " << b;
      ASSERT_EQ(TypeParam::sign(product), sgn(expected)) << a << " * " << b;
    }
  }
}

TYPED_TEST(WideInt, SumsProductsAndSignsOf128And256Bits) {
  const auto values = edge_values();
  std::vector<typename TypeParam::Int128> wides;
  for (std::size_t i = 0; i + 1 < values.size(); ++i) {
    wides.push_back(TypeParam::product(values[i], values[i + 1]));
  }
  auto previous = TypeParam::product(wides.front(), wides.front());
  for (const auto& a : wides) {
    for (const auto& b : wides) {
      // |product of 64-bit integers| <= 2^126, so neither sum nor difference leaves 128 bits.
      ASSERT_EQ(to_big(a + b), to_big(a) + to_big(b));
      ASSERT_EQ(to_big(a - b), to_big(a) - to_big(b));
      const auto product = TypeParam::product(a, b);
      const mpz_class expected = to_big(a) * to_big(b);
      ASSERT_EQ(to_big(product), expected) << to_big(a) << " * " << to_big(b);
      ASSERT_EQ(TypeParam::sign(product), sgn(expected));
      const auto sum = product + previous;
      const auto difference = product - previous;
      ASSERT_EQ(to_big(sum), expected + to_big(previous));
      ASSERT_EQ(to_big(difference), expected - to_big(previous));
      ASSERT_EQ(TypeParam::sign(difference), sgn(mpz_class(expected - to_big(previous))));
      previous = product;
    }
  }
}

// Where a compiler computes, a step beyond a number's limbs is an error.
template <class Arithmetic>
constexpr bool stays_within_its_limbs() {
  const auto product = Arithmetic::product(std::int64_t{-3}, std::int64_t{1} << 40);
  const auto square = Arithmetic::product(product, product);
  const auto none = square + square - square - square;
  return Arithmetic::sign(product) < 0 && Arithmetic::sign(square) > 0 &&
         Arithmetic::sign(none) == 0;
}
static_assert(stays_within_its_limbs<LimbArithmetic>());
#ifdef __SIZEOF_INT128__
static_assert(stays_within_its_limbs<NativeArithmetic>());
#endif

}  // namespace
