// Steiner vertices whose cause has gone. Taking a vertex out never breaks another Delaunay edge, so
// this is always safe; and what must be asked is local.
#include "conforming/prune.h"

#include "conforming/canonical.h"
#include "conforming/conform.h"
#include "conforming/detach.h"
#include "conforming/influence.h"
#include "geometry/predicates_inline.h"
#include "triangulation/change.h"
#include "triangulation/march.h"
#include "triangulation/mesh_state.h"
#include "triangulation/remove.h"
#include "triangulation/segment_store.h"

namespace etcm::internal {
namespace {

// Whether a - b, the neighbours of the Steiner vertex on its feature, would be a Delaunay edge
// without it: some circle through a and b has none of its link strictly inside. On the left the
// link vertex that sees a - b under the greatest angle gives the circle that leans furthest to the
// right; all of the right must be outside that one. `to_b` and `to_a` leave the Steiner vertex.
bool is_needless(const MeshState& m, Edge to_a, Edge to_b) noexcept {
  const Topology& topo = m.topology;
  const Point& a = m.at(topo.target(to_a));
  const Point& b = m.at(topo.target(to_b));
  VertexId foremost{};
  for (Edge e = topo.rotate_ccw(to_b); e != to_a; e = topo.rotate_ccw(e)) {
    const VertexId v = topo.target(e);
    if (v == infinite_vertex) continue;
    if (foremost.is_none() || incircle_fast(a, b, m.at(foremost), m.at(v)) > 0) foremost = v;
  }
  if (foremost.is_none()) return true;
  for (Edge e = topo.rotate_ccw(to_a); e != to_b; e = topo.rotate_ccw(e)) {
    const VertexId v = topo.target(e);
    if (v != infinite_vertex && incircle_fast(a, b, m.at(foremost), m.at(v)) > 0) return false;
  }
  return true;
}

// Other segments' Steiner vertices beside v, which goes. Its own segment's neighbours are looked at
// again anyway.
void queue_around(Change& change, PruneQueue& queue, VertexId v) noexcept {
  MeshState& m = change.mesh;
  const SegmentId own = m.owner(v).segment();
  Spokes spokes(m.topology, v);
  do {
    const VertexId w = spokes.target();
    if (w != infinite_vertex && m.owner(w).role() != Role::node && m.owner(w).segment() != own) {
      touch(change, m.owner(w).segment(), w, w);
      queue.add(m, m.owner(w).segment());
    }
  } while (spokes.turn());
}

// What stands here because of v does not tell of it once v has gone.
void note_taken_out(Change& change, SegmentId s, VertexId v) noexcept {
  MeshState& m = change.mesh;
  if (change.extent == Change::Extent::trial) return;
  if (change.extent == Change::Extent::local) {
    if (m.owner(v).role() == Role::steiner) note_place(change, m.at(v));
  } else if (!find_influenced(change, v, s, on_dependent)) {
    m.knows_dependence = false;
  }
}

void prune_segment(Change& change, PruneQueue& queue, SegmentId s) noexcept {
  MeshState& m = change.mesh;
  SegmentRecord& r = m.segment(s);
  if (r.first == infinite_vertex) return;
  const VertexId from = r.from, to = r.to;
  VertexId v = r.first.is_none() ? from : r.first;
  Point last = m.at(r.first.is_none() ? to : r.last);
  // The next change of this segment, by a removal nearby, starts a range of its own.
  r.first = infinite_vertex;
  if (v == from) v = march(m, v, to).tail;
  while (v != to && m.at(v) <= last) {
    const OwnEdges beside = own_edges(m, v);
    const VertexId before = m.topology.target(beside.back),
                   after = m.topology.target(beside.onward);
    if (!is_needless(m, beside.back, beside.onward)) {
      if (change.extent == Change::Extent::local) m.owner(v) = Owner(Role::steiner, s);
      v = after;
      continue;
    }
    note_taken_out(change, s, v);
    queue_around(change, queue, v);
    if (change.extent == Change::Extent::trial) {
      detach_alone(change, v);
    } else {
      remove_steiner(m, v);
      free_vertex(m, v);
      --m.steiner_count;
    }
    constrain_subsegment(m, between(m, before, after));
    // Both neighbours have lost an edge: what was needed may be no longer.
    if (last < m.at(after)) last = m.at(after);
    v = before == from ? after : before;
  }
}

}  // namespace

void prune(Change& change) noexcept {
  MeshState& m = change.mesh;
  ETCM_VERIFY_THAT(change.dirty.is_empty());
  PruneQueue queue;
  for (SegmentId s = change.touched; !s.is_none(); s = m.segment(s).next_touched) {
    if (is_linked(m, s)) queue.push(m, s);
  }
  queue.sort(m);
  for (SegmentId s = queue.pop(m); !s.is_none(); s = queue.pop(m)) prune_segment(change, queue, s);
}

}  // namespace etcm::internal
