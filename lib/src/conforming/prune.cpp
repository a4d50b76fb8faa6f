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
#include "triangulation/ties.h"

namespace etcm::internal {
namespace {

// A vertex of the link, by a circle that wide integers may have to settle: 2 200 instructions on a
// Cortex-M0+.
constexpr std::uint32_t work_of_test = 2;

// Whether a - b, the neighbours of the Steiner vertex on its feature, would be a Delaunay edge
// without it: some circle through a and b has none of its link strictly inside. On the left the
// link vertex that sees a - b under the greatest angle gives the circle that leans furthest to the
// right; all of the right must be outside that one. `to_b` and `to_a` leave the Steiner vertex.
// Adds what it has looked at to `looked`, where it stops at `most`.
bool is_needless(MeshState& m, Edge to_a, Edge to_b, std::uint32_t most,
                 std::uint32_t& looked) noexcept {
  const Topology& topo = m.topology;
  const Point& a = m.at(topo.target(to_a));
  const Point& b = m.at(topo.target(to_b));
  VertexId foremost{};
  for (Edge e = topo.rotate_ccw(to_b); e != to_a; e = topo.rotate_ccw(e)) {
    if (++looked > most) return false;
    m.work.pass(work_of_test);
    const VertexId v = topo.target(e);
    if (v == infinite_vertex) continue;
    if (foremost.is_none() || incircle_fast(a, b, m.at(foremost), m.at(v)) > 0) foremost = v;
  }
  if (foremost.is_none()) return true;
  for (Edge e = topo.rotate_ccw(to_a); e != to_b; e = topo.rotate_ccw(e)) {
    if (++looked > most) return false;
    m.work.pass(work_of_test);
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
      if (!m.work.spend_whole(Units{queue.size()} + 1)) return;
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
  } else if (!find_influenced(change, v, s, on_dependent) && !m.work.is_over()) {
    m.knows_dependence = false;
  }
}

// Out of the mesh, and where it may have to come back, detached.
void take_out(Change& change, VertexId v) noexcept {
  MeshState& m = change.mesh;
  const Owner owner = m.owner(v);
  remove_steiner(m, v);
  --m.steiner_count;
  if (owner.role() == Role::fresh) --change.fresh_count;
  if (is_taken_back_whole(change) && owner.role() == Role::steiner) {
    m.owner(v) = Owner(Role::detached, owner.segment());
    m.vertex_edges[v.value] = Edge{change.detached.value};
    change.detached = v;
  } else {
    free_vertex(m, v);
  }
}

// For each neighbour that a vertex has more: to take it out, and to put it back.
constexpr Units work_of_neighbour = 20;
constexpr Units work_of_neighbour_back = 13;

// Room for what comes back with a vertex: its two subsegments are looked for and marked, and one
// that is in the way of another vertex breaks before. While it is out two others have up to as many
// more neighbours: what has come in this change and goes before it is back, and a node that has
// gone and is back before it. False: there is none, and the vertex must stay.
bool keep_to_come_back(Change& change, VertexId v, VertexId before, Units degree) noexcept {
  MeshState& m = change.mesh;
  if (!is_taken_back_whole(change)) return true;
  const std::uint32_t beside = m.topology.degree(before, m.work.left());
  if (!m.work.spend(beside)) return false;
  Units more = 3 * Units{beside} + (2 + work_of_neighbour_back) * degree + 16;
  Spokes spokes(m.topology, v);
  do {
    const VertexId w = spokes.target();
    if (w != infinite_vertex && (m.owner(w).role() == Role::fresh || w == change.node)) {
      more += 2 * work_of_neighbour * degree;
      break;
    }
  } while (spokes.turn());
  return m.work.may_keep(more) && keep_walk_back(change, v);
}

bool prune_segment(Change& change, PruneQueue& queue, SegmentId s) noexcept {
  MeshState& m = change.mesh;
  SegmentRecord& r = m.segment(s);
  const VertexId from = r.from, to = r.to;
  auto [v, end] = touched_part(m, s);
  if (v == infinite_vertex) return true;
  bool keeps_fresh = false;
  Point last = m.at(end);
  if (v == from) {
    const Subsegment subsegment = march(m, v, to, m.work.walk());
    if (!m.work.spend(subsegment.steps)) return false;
    v = subsegment.tail;
  }
  while (v != to && m.at(v) <= last) {
    const OwnEdges beside = own_edges(m, v, m.work.left());
    if (!m.work.spend(beside.looked)) return false;
    const VertexId before = m.topology.target(beside.back),
                   after = m.topology.target(beside.onward);
    std::uint32_t looked = 0;
    const bool is_needed =
        !is_needless(m, beside.back, beside.onward, m.work.left() / work_of_test, looked);
    if (!m.work.spend(work_of_test * looked)) return false;
    if (is_needed) {
      keeps_fresh = keeps_fresh || m.owner(v).role() == Role::fresh;
      v = after;
      continue;
    }
    const std::uint32_t degree = m.topology.degree(v, m.work.left());
    if (!may_release(m, beside.back) || !may_release(m, beside.onward)) return false;
    if (!may_remove(change, degree) || !keep_to_come_back(change, v, before, degree)) return false;
    note_taken_out(change, s, v);
    queue_around(change, queue, v);
    if (m.work.is_over()) return false;
    take_out(change, v);
    if (r.first == v) r.first = before;
    if (r.last == v) r.last = after;
    const Subsegment subsegment = between(m, before, after, m.work.walk());
    if (!m.work.spend(subsegment.steps) || !constrain_subsegment(m, subsegment)) {
      touch(change, s, before, after);
      return false;
    }
    // Both neighbours have lost an edge: what was needed may be no longer.
    if (last < m.at(after)) last = m.at(after);
    v = before == from ? after : before;
  }
  // The next change of this segment, by a removal nearby, starts a range of its own; but while
  // there are fresh vertices, they must be found again.
  if (!keeps_fresh || !is_taken_back_whole(change)) leave_untouched(m, s);
  return true;
}

}  // namespace

bool prune(Change& change) noexcept {
  MeshState& m = change.mesh;
  ETCM_VERIFY_THAT(change.dirty.is_empty());
  // A segment's part of sorting them all.
  constexpr std::uint32_t work_of_queueing = 16;
  if (!m.work.spend_whole(Units{work_of_queueing} * change.touched_count)) return false;
  PruneQueue queue;
  for (SegmentId s = change.touched; !s.is_none(); s = m.segment(s).next_touched) {
    if (is_linked(m, s)) queue.push(m, s);
  }
  queue.sort(m);
  for (SegmentId s = queue.pop(m); !s.is_none(); s = queue.pop(m)) {
    if (prune_segment(change, queue, s)) continue;
    queue.clear(m);
    return false;
  }
  return true;
}

}  // namespace etcm::internal
