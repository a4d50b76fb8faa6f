#include "conforming/detach.h"

#include "conforming/canonical.h"
#include "triangulation/change.h"
#include "triangulation/march.h"
#include "triangulation/mesh_state.h"
#include "triangulation/remove.h"
#include "triangulation/segment_store.h"
#include "triangulation/ties.h"

namespace etcm::internal {

void touch_around(Change& change, VertexId v) noexcept {
  MeshState& m = change.mesh;
  if (m.topology.triangle_count() == 0) return;
  Spokes spokes(m.topology, v);
  do {
    const VertexId w = spokes.target();
    if (w != infinite_vertex && m.owner(w).role() != Role::node) {
      touch(change, m.owner(w).segment(), w, w);
    }
  } while (spokes.turn());
}

void detach(Change& change, VertexId steiner) noexcept {
  touch_around(change, steiner);
  detach_alone(change, steiner);
}

void detach_alone(Change& change, VertexId steiner) noexcept {
  MeshState& m = change.mesh;
  const Owner owner = m.owner(steiner);
  if (owner.role() == Role::steiner) note_place(change, m.at(steiner));
  remove_steiner(m, steiner);
  --m.steiner_count;
  if (owner.role() == Role::fresh) {
    free_vertex(m, steiner);
    return;
  }
  m.owner(steiner) = Owner(Role::detached, owner.segment());
  m.vertex_edges[steiner.value] = Edge{change.detached.value};
  change.detached = steiner;
}

namespace {

// What of a segment is not yet laid may meet another segment's vertices: there its own have ended.
bool stands_on(const MeshState& m, VertexId v, SegmentId s) noexcept {
  return m.owner(v).role() != Role::node && m.owner(v).segment() == s;
}

}  // namespace

void strip_segment(Change& change, SegmentId s) noexcept {
  MeshState& m = change.mesh;
  touch(change, s);
  const VertexId from = m.segment(s).from, to = m.segment(s).to;
  for (;;) {
    const Subsegment subsegment = march(m, from, to);
    if (subsegment.tail != to) {
      if (!stands_on(m, subsegment.tail, s)) return;
      detach(change, subsegment.tail);
      continue;
    }
    if (subsegment.is_edge && m.topology.is_constrained(subsegment.edge)) {
      note_mark(change, subsegment.edge);
      release_constraint(m, subsegment.edge);
    }
    return;
  }
}

void drop_fresh(Change& change) noexcept {
  MeshState& m = change.mesh;
  for (SegmentId s = change.touched; !s.is_none(); s = m.segment(s).next_touched) {
    if (!is_linked(m, s)) continue;
    const VertexId end = m.segment(s).to;
    VertexId v = m.segment(s).from;
    while (v != end) {
      const VertexId w = march(m, v, end).tail;
      if (w != end && !stands_on(m, w, s)) break;
      if (m.owner(w).role() == Role::fresh) {
        detach(change, w);
      } else {
        v = w;
      }
    }
  }
}

}  // namespace etcm::internal
