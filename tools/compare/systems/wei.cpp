// Wei, Xiao, Zhou, from what the ETCM paper tells: from the end that was given first, as far as its
// circle reaches, and again from there; where the circle of the other end overlaps, the middle of
// the overlap finishes the rest.
#include "compare/systems/rival.h"
#include "compare/systems/system.h"

namespace etcm::compare {
namespace {

void finish_in_overlap(const MissingSubsegment& missing, std::vector<Parameter>& places) {
  const SplitSite site = missing.site();
  places.push_back(site.feasible_head >= site.feasible_tail
                       ? middle_of(site.feasible_tail, site.feasible_head)
                       : site.feasible_head);
}

// Never looks at the other end, and so leaves whatever the last circle does.
void always_first_circle(const MissingSubsegment& missing, std::vector<Parameter>& places) {
  const Parameter reach = missing.site().feasible_head;
  // Where the circle reaches nothing or everything, the grid leaves no first end to finish.
  places.push_back(
      reach > missing.head && reach < missing.tail ? reach : middle_of(missing.head, missing.tail));
}

}  // namespace

Attempt run_wei(const inputs::Graph& graph, Depth depth) {
  return run_rival(graph, {.split = finish_in_overlap}, depth);
}

Attempt run_wei_first_circle(const inputs::Graph& graph, Depth depth) {
  return run_rival(graph, {.split = always_first_circle}, depth);
}

}  // namespace etcm::compare
