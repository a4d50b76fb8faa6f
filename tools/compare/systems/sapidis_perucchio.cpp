// Sapidis and Perucchio: the middle of a missing subsegment, and again on what is still missing.
#include "compare/systems/rival.h"
#include "compare/systems/system.h"

namespace etcm::compare {

Attempt run_sapidis_perucchio(const inputs::Graph& graph, Depth depth) {
  return run_rival(graph, {.split = split_in_the_middle}, depth);
}

}  // namespace etcm::compare
