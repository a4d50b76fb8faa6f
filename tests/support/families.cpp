#include "support/families.h"

#include "inputs/patterns.h"
#include "inputs/random_graph.h"

namespace etcm::test {

Graph graph_of_some_family(inputs::Random& random) {
  const std::uint64_t seed = random.next();
  const auto small = [&](std::size_t low, std::size_t high) {
    return low + random.index(high - low + 1);
  };
  const auto length = [&](std::int32_t low, std::int32_t high) {
    return random.between(low, high);
  };
  switch (random.below(13)) {
    case 0:
      return inputs::random_graph(small(8, 60), inputs::FeatureLength::any, seed);
    case 1:
      return inputs::random_graph(small(60, 400), inputs::FeatureLength::in_reach, seed);
    case 2:
      return inputs::random_graph(small(60, 200), inputs::FeatureLength::any, seed);
    case 3:
      return inputs::random_clusters(small(2, 5), small(6, 20), seed);
    case 4:
      return inputs::fan({small(3, 12), length(100, 8000), 1000, 30'000, seed});
    case 5:
      return inputs::comb(small(4, 14), length(1, 20), 1000, length(0, 30));
    case 6:
      return inputs::parallels(small(2, 4), length(1, 20), 10'000, small(5, 40), seed);
    case 7:
      return inputs::grid(small(3, 9), length(1, 30), inputs::GridFeatures::random_segments, seed);
    case 8:
      return inputs::grid(small(3, 8), 10, inputs::GridFeatures::knight_moves, seed);
    case 9:
      return inputs::grid(small(3, 8), length(1, 30), inputs::GridFeatures::cell_diagonals, seed);
    case 10:
      return inputs::ladder(small(4, 20), 10, length(5, 60), length(0, 40));
    case 11:
      return inputs::nested_squares(small(3, 8), 100, length(0, 3000));
    default:
      return inputs::random_polygon(small(6, 60), seed);
  }
}

}  // namespace etcm::test
