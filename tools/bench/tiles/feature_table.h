// Which tiles the laying of a feature depends on: by what is proved, and by what is seen.
#pragma once

#include <cstddef>
#include <cstdint>

namespace etcm::bench {

struct FeatureTableOptions {
  std::size_t nodes = 0;
  std::uint32_t tiles = 0;  // about so many
  std::size_t samples = 0;  // features that are taken out, and laid by themselves
  std::uint64_t seed = 0;
};

// Prints a table of sites with more and fewer, short and long features. Whether all that was laid
// from what it is proved to depend on came to what the one mesh has.
bool print_feature_table(const FeatureTableOptions& options);

}  // namespace etcm::bench
