#include "etcm/incidence.h"

#include "mesh/least_entries.h"
#include "triangulation/mesh_state.h"
#include "triangulation/segment_store.h"

namespace etcm {
inline namespace ETCM_IDS {

using namespace internal;

std::uint32_t features_at(const Mesh& mesh, VertexId vertex, std::span<FeatureAt> out) noexcept {
  const MeshState& m = opened(mesh, Call::features_at);
  demand(m.is_vertex(vertex), Call::features_at, Fault::no_vertex);
  if (!m.is_node(vertex)) {
    if (!out.empty()) out[0] = {internal::feature_of(m, m.owner(vertex).segment()), false};
    return 1;
  }
  LeastEntries found(
      out, [](const FeatureAt& a, const FeatureAt& b) noexcept { return a.feature < b.feature; });
  std::uint32_t count = 0;
  StepBound bound(m.segment_end);
  for (SegmentId s = m.owner(vertex).segment(); !s.is_none(); s = next_at(m, s, vertex)) {
    bound.step();
    const SegmentRecord& r = m.segment(s);
    const FeatureId feature = internal::feature_of(m, s);
    const bool is_last = r.to == vertex;
    // A feature that runs through has two segments here: one ends, and the next one counts.
    if (is_last && !r.next.is_none()) continue;
    found.offer({feature, is_last || s.value == feature.value});
    ++count;
  }
  found.sort();
  return count;
}

FeatureId feature_between(const Mesh& mesh, VertexId from, VertexId to) noexcept {
  const MeshState& m = opened(mesh, Call::feature_between);
  demand(m.is_vertex(from) && m.is_vertex(to), Call::feature_between, Fault::no_vertex);
  Edge e;
  if (m.topology.triangle_count() == 0 || !m.topology.find_edge(from, to, e) ||
      !m.topology.is_constrained(e)) {
    return FeatureId::none();
  }
  return internal::feature_of(m, segment_of_edge(m, from, to));
}

}  // namespace ETCM_IDS
}  // namespace etcm
