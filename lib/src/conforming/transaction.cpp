// All or nothing in fixed memory. The triangulation is canonical, so going back needs no record of
// flips: it is enough to know which vertices came, and to keep the ones that went. A vertex that
// goes keeps its place (detached) until the change ends; one that comes is marked fresh.
#include "conforming/transaction.h"

#include "conforming/canonical.h"
#include "conforming/conform.h"
#include "conforming/detach.h"
#include "conforming/prune.h"
#include "etcm/dry_run.h"
#include "triangulation/change.h"
#include "triangulation/insert.h"
#include "triangulation/locate.h"
#include "triangulation/march.h"
#include "triangulation/mesh_state.h"
#include "triangulation/segment_store.h"

namespace etcm::internal {

// A batch does not keep the segments together that it has touched, so it looks at all vertices; and
// no segment goes in it.
void end_change(Change& change) noexcept {
  MeshState& m = change.mesh;
  ETCM_VERIFY_THAT(change.dirty.is_empty() && change.detached.is_none());
  if (change.extent == Change::Extent::whole) {
    for (IdValue i = 1; i < m.vertex_end; ++i) {
      m.work.pass_entry(i);
      Owner& owner = m.owners[i];
      if (owner.role() == Role::fresh) owner = Owner(Role::steiner, owner.segment());
    }
  }
  while (!change.touched.is_none()) {
    const SegmentId s = change.touched;
    change.touched = m.segment(s).next_touched;
    m.segment(s).next_touched = not_listed;
    if (m.segment(s).from.is_none() && !is_free(m, s)) {
      forget_segment(m, s);
      free_segment(m, s);
    }
  }
  change.recycled_segments = SegmentId::none();
}

void begin_going_back(Change& change, Status status) noexcept {
  MeshState& m = change.mesh;
  m.error_detail.status = status;
  m.work.go_back();
  change.dirty.clear(m);
  drop_fresh(change);
}

namespace {

// Those that a segment has in the part that is touched.
void restore_marks(MeshState& m, SegmentId s) noexcept {
  const VertexId to = m.segment(s).to;
  for (auto [v, last] = touched_part(m, s); v != last;) {
    const Subsegment subsegment = march(m, v, to, m.work.whole_walk());
    m.work.add(subsegment.steps);
    ETCM_VERIFY_THAT(can_be_edge(m, subsegment));
    static_cast<void>(constrain_subsegment(m, subsegment));
    v = subsegment.tail;
  }
}

// Once nothing can fail: what is fresh has come to stay. It is within the part of its segment that
// is touched.
// Not inline: most changes have none.
[[gnu::noinline]] void settle_fresh(Change& change) noexcept {
  MeshState& m = change.mesh;
  for (SegmentId s = change.touched; !s.is_none() && change.fresh_count != 0;
       s = m.segment(s).next_touched) {
    if (!is_linked(m, s)) continue;
    for (auto [v, last] = touched_part(m, s); v != last;) {
      if (m.owner(v).role() == Role::fresh) {
        m.owner(v) = Owner(Role::steiner, s);
        --change.fresh_count;
      }
      const Subsegment subsegment = march(m, v, m.segment(s).to, m.work.whole_walk());
      m.work.add(subsegment.steps);
      v = subsegment.tail;
    }
  }
  ETCM_VERIFY_THAT(change.fresh_count == 0);
}

}  // namespace

void put_back(Change& change, VertexId v) noexcept {
  MeshState& m = change.mesh;
  const Found found = find(m, m.at(v), m.walk_start, m.work.whole_walk());
  m.work.add(found.steps);
  static_cast<void>(insert_vertex(change, v, found));
}

void restore_detached(Change& change) noexcept {
  MeshState& m = change.mesh;
  if (!change.beside_detached.is_none() && m.topology.triangle_count() != 0) {
    m.walk_start = m.topology.edge_at(change.beside_detached);
  }
  while (!change.detached.is_none()) {
    const VertexId v = change.detached;
    change.detached = VertexId{m.vertex_edges[v.value].value};
    m.owner(v) = Owner(Role::steiner, m.owner(v).segment());
    ++m.steiner_count;
    put_back(change, v);
  }
  change.dirty.clear(m);
  for (SegmentId s = change.touched; !s.is_none(); s = m.segment(s).next_touched) {
    if (is_linked(m, s)) restore_marks(m, s);
  }
  end_change(change);
  forget_places(change);
  forget_new_ids(change);
}

// An id is new only where none was free any more, so each free one was given out in this change.
void forget_new_ids(Change& change) noexcept {
  lower_ends(change.mesh, change.vertex_end_before, change.segment_end_before);
}

void settle(Change& change) noexcept {
  MeshState& m = change.mesh;
  while (!change.detached.is_none()) {
    const VertexId v = change.detached;
    change.detached = VertexId{m.vertex_edges[v.value].value};
    free_vertex(m, v);
  }
  if (change.fresh_count != 0 && is_taken_back_whole(change)) settle_fresh(change);
  if (change.extent == Change::Extent::local) {
    for (SegmentId s = change.touched; !s.is_none(); s = m.segment(s).next_touched)
      make_stale(m, s);
  }
  end_change(change);
}

Status commit(Change& change) noexcept {
  MeshState& m = change.mesh;
  if (!prune(change)) return m.error_detail.status = Status::work_limit;
  if (m.outcome != nullptr) {
    m.outcome->status = Status::ok;
    m.outcome->steiner += static_cast<std::int32_t>(m.steiner_count);
    m.outcome->work = m.work.needed();
    return Status::work_limit;
  }
  settle(change);
  return Status::ok;
}

}  // namespace etcm::internal
