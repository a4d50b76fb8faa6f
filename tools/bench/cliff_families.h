// Inputs and changes that could make the mesher slow, each of any size.
#pragma once

#include <cstddef>
#include <span>

namespace etcm::bench {

struct CliffFamily {
  const char* name;
  std::size_t size_min;              // the smallest that is measured; the others double
  double (*seconds)(std::size_t n);  // throws std::runtime_error where the mesh refuses
};

std::span<const CliffFamily> cliff_families();

}  // namespace etcm::bench
