// The minimum spanning tree by Boruvka's rule: in each round every part takes the shortest edge out
// of it. Needs no order of the edges, and so no memory for one.
#include <limits>

#include "analysis/internal.h"
#include "triangulation/mesh_state.h"
#include "triangulation/pulse.h"

namespace etcm {
inline namespace ETCM_IDS {

using namespace internal;

namespace {

class Forest {
 public:
  Forest(const MeshState& m, std::span<ConnectivityScratch> scratch) noexcept
      : m_(m), scratch_(scratch) {
    for (IdValue v = 0; v < m.vertex_end; ++v) scratch_[v].part = VertexId{v};
  }

  Connectivity grow(const SquaredLength& feasible) noexcept {
    Connectivity result;
    result.parts = m_.vertex_count() == 0 ? 0u : 1u;
    // A part joins at least one other in each round, so there are half as many afterwards.
    for (StepBound rounds(std::numeric_limits<IdValue>::digits); choose(); rounds.step()) {
      Pulse pulse(m_);
      for (IdValue v = 1; v < m_.vertex_end; ++v) {
        pulse.pass(2);
        const Edge e{scratch_[v].edge};
        if (e.is_none()) continue;
        const VertexId from = m_.topology.origin(e), to = m_.topology.target(e);
        const VertexId one = part_of(from), other = part_of(to);
        if (one == other) continue;
        scratch_[one.value].part = other;
        const SquaredLength length = length_of(e);
        if (length > feasible) ++result.parts;
        if (length > result.least) {
          result.least = length;
          result.from = from;
          result.to = to;
        }
      }
    }
    return result;
  }

 private:
  SquaredLength length_of(Edge e) const noexcept {
    return squared_distance(m_.at(m_.topology.origin(e)), m_.at(m_.topology.target(e)));
  }

  VertexId part_of(VertexId v) noexcept {
    for (StepBound bound(m_.vertex_end); scratch_[v.value].part != v; bound.step()) {
      VertexId& above = scratch_[v.value].part;
      above = scratch_[above.value].part;
      v = above;
    }
    return v;
  }

  // Gives each part its shortest edge outwards; false once there is none. Of edges of one length
  // the first counts for both of their parts, so the chosen ones close no cycle.
  bool choose() noexcept {
    for (IdValue v = 0; v < m_.vertex_end; ++v) scratch_[v].edge = Edge{}.value;
    bool found = false;
    for_each_edge(m_, [&](Edge e) noexcept {
      const VertexId one = part_of(m_.topology.origin(e));
      const VertexId other = part_of(m_.topology.target(e));
      if (one == other) return;
      found = true;
      const SquaredLength length = length_of(e);
      for (const VertexId part : {one, other}) {
        const Edge best{scratch_[part.value].edge};
        if (best.is_none() || length < length_of(best)) scratch_[part.value].edge = e.value;
      }
    });
    return found;
  }

  const MeshState& m_;
  std::span<ConnectivityScratch> scratch_;
};

}  // namespace

Status connectivity(const Mesh& mesh, std::uint32_t radio_range,
                    std::span<ConnectivityScratch> scratch, Connectivity& out) noexcept {
  const MeshState& m = opened(mesh, Call::connectivity);
  demand(radio_range != 0, Call::connectivity, Fault::zero_range);
  if (scratch.size() < m.vertex_end) return Status::buffer_too_small;
  out = Forest(m, scratch).grow(squared_range(radio_range, 0));
  return Status::ok;
}

}  // namespace ETCM_IDS
}  // namespace etcm
