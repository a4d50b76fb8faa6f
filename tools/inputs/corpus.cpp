#include "inputs/corpus.h"

#include "inputs/patterns.h"
#include "inputs/random_graph.h"

namespace etcm::inputs {

std::vector<CorpusEntry> corpus() {
  constexpr auto any = FeatureLength::any;
  constexpr auto in_reach = FeatureLength::in_reach;
  return {
      {"random long", random_graph(60, any, 1)},
      {"random long", random_graph(200, any, 1)},
      {"random long", random_graph(500, any, 1)},
      {"random long", random_graph(1000, any, 1)},
      {"random long", random_graph(1000, any, 2)},
      {"random long", random_graph(1000, any, 3)},
      {"random long", random_graph(5000, any, 1)},
      {"random short", random_graph(200, in_reach, 1)},
      {"random short", random_graph(1000, in_reach, 1)},
      {"random short", random_graph(5000, in_reach, 1)},
      {"clusters", random_clusters(8, 60, 1)},
      {"clusters", random_clusters(40, 25, 2)},
      {"fan", fan({50, 200, 1000, 100'000, 1})},
      {"fan", fan({50, 7200, 1000, 100'000, 1})},
      {"fan", fan({50, 1500, 10'000, 10'000, 1})},
      {"fan", fan({50, 1500, 5000, 20'000, 2})},
      {"fan", fan({360, 1000, 30'000, 100'000, 1})},
      {"fan", fan({360, 1000, 100'000, 100'000, 1})},
      {"narrow angle", fan({2, 10, 1'000'000, 10'000'000, 1})},
      {"narrow angle", fan({20, 10, 100'000, 10'000'000, 1})},
      {"narrow angle", zigzag(20, 10, 1'000'000)},
      {"narrow angle", zigzag(40, 1000, 10'000)},
      {"comb", comb(100, 10, 1000, 0)},
      {"comb", comb(100, 10, 1000, 5)},
      {"comb", comb(100, 10, 1000, 333)},
      {"parallels", parallels(2, 1, 100'000, 40, 1)},
      {"parallels", parallels(2, 1, 100'000, 400, 2)},
      {"parallels", parallels(10, 1, 100'000, 100, 3)},
      {"grid", grid(30, 10, GridFeatures::cell_diagonals, 1)},
      {"grid", grid(30, 10, GridFeatures::long_diagonals, 1)},
      {"grid", grid(30, 10, GridFeatures::knight_moves, 1)},
      {"grid", grid(30, 10, GridFeatures::random_segments, 1)},
      {"spiral", spiral(200, 10'000, 10)},
      {"spiral", spiral(300, 30'000, 100)},
      {"nearly collinear", nearly_collinear(500, 2, 20, 1)},
      {"nearly collinear", nearly_collinear(500, 50, 60, 2)},
      {"circle", circle(360, 100'000, 60, 1)},
      {"circle", exact_circle(80, 1)},
      {"star", star(40, 1000, 10'000)},
      {"star", star(180, 9000, 10'000)},
      {"ladder", ladder(100, 10, 1000, 0)},
      {"ladder", ladder(100, 10, 1000, 200)},
      {"nested squares", nested_squares(50, 100, 0)},
      {"nested squares", nested_squares(40, 100, 1000)},
      {"polygon", random_polygon(300, 1)},
      {"collinear", collinear(500, 7)},
  };
}

}  // namespace etcm::inputs
