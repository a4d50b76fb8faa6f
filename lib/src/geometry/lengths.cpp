#include "geometry/lengths.h"

#include <type_traits>

#include "geometry/wide_int.h"

namespace etcm {
inline namespace ETCM_IDS {

using namespace internal;

namespace {

template <class Int>
SquaredLength to_length(const Int& square) noexcept {
  if constexpr (std::is_same_v<Int, LimbArithmetic::Int128>) {
    const auto word = [&square](unsigned i) noexcept {
      return (std::uint64_t{square.limb[i + 1]} << 32) | square.limb[i];
    };
    return {word(2), word(0)};
  } else {
    return {static_cast<std::uint64_t>(square >> 64), static_cast<std::uint64_t>(square)};
  }
}

}  // namespace

SquaredLength squared_distance(const Point& a, const Point& b) noexcept {
  const std::int64_t x = b.x - a.x, y = b.y - a.y;
  return to_length(ExactArithmetic::product(x, x) + ExactArithmetic::product(y, y));
}

std::uint32_t range_for(const SquaredLength& length) noexcept {
  std::uint32_t range = 0;
  for (int bit = 31; bit >= 0; --bit) {
    const std::uint32_t longer = range + (std::uint32_t{1} << bit);
    if (squared_range(longer, 0) < length) range = longer;
  }
  return length == SquaredLength{} ? 0 : range + 1;
}

}  // namespace ETCM_IDS
}  // namespace etcm
