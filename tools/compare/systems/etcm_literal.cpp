// ETCM word for word: the split rule of Algorithm 2, features as they come, no pruning. Not the
// library's `paper` policy, which is that rule inside our build and needs other counts.
#include "compare/systems/etcm_literal.h"

#include "compare/systems/system.h"

namespace etcm::compare {

void split_literally(const MissingSubsegment& missing, std::vector<Parameter>& places) {
  const SplitSite site = missing.site();
  const Parameter q1 = site.feasible_head, q2 = site.feasible_tail;
  if (q1 >= q2) {
    places.push_back(middle_of(q2, q1));  // step 6
  } else {
    // Steps 5-1 and 5-2: of two equal parts the one at the end that was given first.
    places.push_back(q1 - site.head >= site.tail - q2 ? q1 : q2);
  }
}

Attempt run_etcm(const inputs::Graph& graph, Depth depth) {
  return run_rival(graph, {.split = split_literally}, depth);
}

Attempt run_etcm_stack(const inputs::Graph& graph, Depth depth) {
  return run_rival(graph, {.split = split_literally, .broken_first = BrokenFirst::latest}, depth);
}

}  // namespace etcm::compare
