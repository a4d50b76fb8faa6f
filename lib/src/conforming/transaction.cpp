// All or nothing in fixed memory. The triangulation is canonical, so going back needs no record of
// flips: it is enough to know which vertices came, and to keep the ones that went. A vertex that
// goes keeps its place (detached) until the change ends; one that comes is marked fresh.
#include "conforming/transaction.h"

#include "conforming/canonical.h"
#include "conforming/conform.h"
#include "conforming/detach.h"
#include "conforming/prune.h"
#include "triangulation/change.h"
#include "triangulation/insert.h"
#include "triangulation/locate.h"
#include "triangulation/march.h"
#include "triangulation/mesh_state.h"
#include "triangulation/segment_store.h"

namespace etcm::internal {

// A batch does not keep the touched segments together, so it looks at all.
void end_change(Change& change) noexcept {
  MeshState& m = change.mesh;
  ETCM_VERIFY_THAT(change.dirty.is_empty() && change.detached.is_none());
  if (change.extent == Change::Extent::whole) {
    for (IdValue i = 0; i < m.segment_end; ++i) {
      if (m.segment(SegmentId{i}).from.is_none()) touch(change, SegmentId{i});
    }
    for (IdValue i = 1; i < m.vertex_end; ++i) {
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

void restore_detached(Change& change) noexcept {
  MeshState& m = change.mesh;
  while (!change.detached.is_none()) {
    const VertexId v = change.detached;
    change.detached = VertexId{m.vertex_edges[v.value].value};
    m.owner(v) = Owner(Role::steiner, m.owner(v).segment());
    ++m.steiner_count;
    insert_vertex(change, v, find(m, m.at(v), m.walk_start));
  }
  change.dirty.clear(m);
  for (SegmentId s = change.touched; !s.is_none(); s = m.segment(s).next_touched) {
    if (!is_linked(m, s)) continue;
    const VertexId end = m.segment(s).to;
    VertexId v = m.segment(s).from;
    while (v != end) {
      const Subsegment subsegment = march(m, v, end);
      ETCM_VERIFY_THAT(can_be_edge(m, subsegment));
      constrain_subsegment(m, subsegment);
      v = subsegment.tail;
    }
  }
  end_change(change);
  forget_places(change);
  forget_new_ids(change);
}

// An id is new only where none was free any more, so each free one was given out in this change.
void forget_new_ids(Change& change) noexcept {
  lower_ends(change.mesh, change.vertex_end_before, change.segment_end_before);
}

void free_detached(Change& change) noexcept {
  MeshState& m = change.mesh;
  while (!change.detached.is_none()) {
    const VertexId v = change.detached;
    change.detached = VertexId{m.vertex_edges[v.value].value};
    free_vertex(m, v);
  }
}

void commit(Change& change) noexcept {
  MeshState& m = change.mesh;
  free_detached(change);
  prune(change);
  if (change.extent == Change::Extent::local) {
    for (SegmentId s = change.touched; !s.is_none(); s = m.segment(s).next_touched)
      make_stale(m, s);
  }
  end_change(change);
}

}  // namespace etcm::internal
