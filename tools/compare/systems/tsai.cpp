// Tsai: a point on every crossing of the missing subsegment with the edges of the mesh as it
// stands, and again on what is still missing. On the grid the crossing is the nearest place on the
// feature.
#include <algorithm>

#include "compare/systems/crossed.h"
#include "compare/systems/system.h"

namespace etcm::compare {
namespace {

using Places = std::vector<Parameter>;

// Beside a crossing that rounds onto an end there is still the middle.
void add_middle_if_empty(const MissingSubsegment& missing, Places& places) {
  if (places.empty()) places.push_back(middle_of(missing.head, missing.tail));
}

void split_at_all_crossings(const MissingSubsegment& missing, Places& places) {
  for_each_crossed(
      missing, [&](internal::Edge e) { add_if_inside(missing, crossing_of(missing, e), places); });
  std::sort(places.begin(), places.end());
  add_middle_if_empty(missing, places);
}

// The other reading: each point changes the mesh, and the next crossing is one with the new mesh.
void split_at_first_crossing(const MissingSubsegment& missing, Places& places) {
  add_if_inside(missing, crossing_of(missing, missing.subsegment.head_edge), places);
  add_middle_if_empty(missing, places);
}

}  // namespace

Attempt run_tsai(const inputs::Graph& graph, Depth depth) {
  return run_rival(graph, {.split = split_at_all_crossings}, depth);
}

Attempt run_tsai_one(const inputs::Graph& graph, Depth depth) {
  return run_rival(graph, {.split = split_at_first_crossing}, depth);
}

}  // namespace etcm::compare
