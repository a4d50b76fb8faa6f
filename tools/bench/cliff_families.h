// Inputs and changes that could make the mesher slow, each of any size.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace etcm::bench {

struct Cost {
  double seconds;  // of the processor
  // The same on every machine: units of work, and those after which a keep_alive() hook is called,
  // for it is so for work that no limit knows of too.
  std::uint64_t units;
};

struct CliffFamily {
  const char* name;
  std::size_t size_min;         // the smallest that is measured; the others double
  Cost (*cost)(std::size_t n);  // throws std::runtime_error where the mesh refuses
};

std::span<const CliffFamily> cliff_families();

struct Growth {
  std::uint64_t units;  // of work at the smallest size
  double exponent;      // from a quarter of that size up to it: 1 is linear
};

Growth growth_of(const CliffFamily& family);

}  // namespace etcm::bench
