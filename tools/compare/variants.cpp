#include "compare/variants.h"

#include <numeric>
#include <utility>

#include "inputs/random.h"

namespace etcm::compare {

inputs::Graph exchanged(const inputs::Graph& graph) {
  inputs::Graph result = graph;
  for (FeatureEnds& ends : result.features) std::swap(ends.from, ends.to);
  return result;
}

inputs::Graph shuffled(const inputs::Graph& graph, std::uint64_t seed) {
  inputs::Random random(seed);
  std::vector<std::size_t> place(graph.nodes.size());
  std::iota(place.begin(), place.end(), std::size_t{0});
  inputs::shuffle(place, random);
  inputs::Graph result = graph;
  for (std::size_t i = 0; i < place.size(); ++i) result.nodes[place[i]] = graph.nodes[i];
  for (FeatureEnds& ends : result.features) {
    ends = inputs::between_nodes(place[inputs::node_index_of(ends.from)],
                                 place[inputs::node_index_of(ends.to)]);
  }
  inputs::shuffle(result.features, random);
  return result;
}

}  // namespace etcm::compare
