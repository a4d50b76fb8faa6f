#include "conforming/running_change.h"

#include "triangulation/march.h"
#include "triangulation/mesh_state.h"
#include "triangulation/remove.h"
#include "triangulation/segment_store.h"
#include "triangulation/ties.h"
#include "triangulation/worklist.h"

namespace etcm::internal {

void begin(MeshState& m) noexcept {
  m.error_detail = ErrorDetail{};
  m.steps = 0;
  m.is_batch = false;
}

void touch_around(MeshState& m, VertexId v) noexcept {
  if (m.topology.triangle_count() == 0) return;
  Spokes spokes(m.topology, v);
  do {
    const VertexId w = spokes.target();
    if (w != infinite_vertex && m.owner(w).role() != Role::node) {
      touch(m, m.owner(w).segment(), w, w);
    }
  } while (spokes.turn());
}

void detach(MeshState& m, VertexId steiner) noexcept {
  touch_around(m, steiner);
  const Owner owner = m.owner(steiner);
  remove_steiner(m, steiner);
  --m.steiner_count;
  if (owner.role() == Role::fresh) {
    free_vertex(m, steiner);
    return;
  }
  m.owner(steiner) = Owner(Role::detached, owner.segment());
  m.vertex_edges[steiner.value] = Edge{m.detached.value};
  m.detached = steiner;
}

void strip_segment(MeshState& m, SegmentId s) noexcept {
  touch(m, s);
  const VertexId from = m.segment(s).from, to = m.segment(s).to;
  for (;;) {
    const Subsegment subsegment = march(m, from, to);
    if (subsegment.tail != to) {
      detach(m, subsegment.tail);
      continue;
    }
    if (subsegment.is_edge && m.topology.is_constrained(subsegment.edge))
      release_constraint(m, subsegment.edge);
    return;
  }
}

void drop_fresh(MeshState& m) noexcept {
  for (SegmentId s = m.touched; !s.is_none(); s = m.segment(s).next_touched) {
    if (!is_linked(m, s)) continue;
    const VertexId end = m.segment(s).to;
    VertexId v = m.segment(s).from;
    while (v != end) {
      const VertexId w = march(m, v, end).tail;
      if (m.owner(w).role() == Role::fresh) {
        detach(m, w);
      } else {
        v = w;
      }
    }
  }
}

}  // namespace etcm::internal
