// ETCM as the paper has it: its split rule, features as they come, no pruning. (The library's own
// `paper` policy adds a canonical order and pruning, so it needs fewer.)
#include "compare/rival.h"
#include "compare/system.h"

namespace etcm::compare {

Attempt run_etcm(const inputs::Graph& graph, Depth depth) {
  return run_rival(graph, {.policy = split_paper}, depth);
}

}  // namespace etcm::compare
