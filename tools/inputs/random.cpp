#include "inputs/random.h"

#include <limits>

namespace etcm::inputs {

std::uint64_t Random::next() noexcept {
  state_ += 0x9e3779b97f4a7c15u;
  std::uint64_t z = state_;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

std::uint64_t Random::below(std::uint64_t count) noexcept {
  // The numbers above the last whole multiple of `count` would favour the small remainders.
  const std::uint64_t excess = (std::numeric_limits<std::uint64_t>::max() % count + 1) % count;
  const std::uint64_t last = std::numeric_limits<std::uint64_t>::max() - excess;
  std::uint64_t value = next();
  while (value > last) value = next();
  return value % count;
}

std::int32_t Random::between(std::int32_t low, std::int32_t high) noexcept {
  const auto count = static_cast<std::uint64_t>(std::int64_t{high} - low + 1);
  return static_cast<std::int32_t>(low + static_cast<std::int64_t>(below(count)));
}

}  // namespace etcm::inputs
