#include "geometry/root.h"

#include <bit>
#include <cmath>
#include <cstdint>

#include "etcm/policy.h"

namespace etcm {
inline namespace ETCM_IDS {

double root(double square) noexcept { return internal::root_of(square); }

}  // namespace ETCM_IDS

namespace internal {

// Digit by digit: of the square of 54 bits, with the last bit of the root for rounding. That bit is
// no tie: a root that ends there has a square that is longer than a double's digits.
double root_by_digits(double square) noexcept {
  constexpr int digits = 52, bias = 1023;
  const auto bits = std::bit_cast<std::uint64_t>(square);
  const int exponent = static_cast<int>(bits >> digits) - bias;
  // Zero, less, or no number; none of them comes.
  if (exponent <= -bias || exponent > bias) return 0;
  std::uint64_t part = (bits & ((std::uint64_t{1} << digits) - 1)) | std::uint64_t{1} << digits;
  if ((exponent & 1) != 0) part <<= 1;
  part <<= 64 - 54;  // two digits at a time from the top
  std::uint64_t root = 0, rest = 0;
  for (int digit = 0; digit < 54; ++digit) {
    rest = rest << 2 | part >> 62;
    part <<= 2;
    const std::uint64_t trial = root << 2 | 1;
    root <<= 1;
    if (rest >= trial) {
      rest -= trial;
      root |= 1;
    }
  }
  root = (root + 1) >> 1;
  // Its leading digit adds one to the exponent; so does one that rounding has carried.
  const auto half = static_cast<std::uint64_t>((exponent >> 1) + bias - 1);
  return std::bit_cast<double>((half << digits) + root);
}

}  // namespace internal
}  // namespace etcm
