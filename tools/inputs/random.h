// A generator of pseudo-random numbers that gives the same numbers on every machine: the standard
// library fixes its engines but not its distributions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace etcm::inputs {

// A Weyl sequence through a 64-bit finalizer (Steele, Lea, Flood: Fast splittable pseudorandom
// number generators, 2014). Every seed is as good as any other, 0 included.
class Random {
 public:
  explicit Random(std::uint64_t seed) noexcept : state_(seed) {}

  std::uint64_t next() noexcept;

  // Uniform in [0, count), without bias. `count` must not be 0.
  std::uint64_t below(std::uint64_t count) noexcept;
  // The same, of something in memory.
  std::size_t index(std::size_t count) noexcept { return static_cast<std::size_t>(below(count)); }

  // Uniform in [low, high], both included; low <= high.
  std::int32_t between(std::int32_t low, std::int32_t high) noexcept;

 private:
  std::uint64_t state_;
};

template <class T>
void shuffle(std::vector<T>& items, Random& random) {
  for (std::size_t left = items.size(); left > 1; --left) {
    std::swap(items[left - 1], items[random.index(left)]);
  }
}

}  // namespace etcm::inputs
