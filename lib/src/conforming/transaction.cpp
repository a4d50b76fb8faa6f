// All or nothing in fixed memory. The triangulation is canonical, so going back needs no record of
// flips: it is enough to know which vertices came, and to keep the ones that went. A vertex that
// goes keeps its place (detached) until the change ends; one that comes is marked fresh.
#include "conforming/transaction.h"

#include "conforming/conform.h"
#include "conforming/prune.h"
#include "conforming/running_change.h"
#include "triangulation/insert.h"
#include "triangulation/locate.h"
#include "triangulation/march.h"
#include "triangulation/mesh_state.h"
#include "triangulation/segment_store.h"
#include "triangulation/worklist.h"

namespace etcm::internal {

// A batch does not keep the touched segments together, so it looks at all.
void end_change(MeshState& m) noexcept {
  if (m.is_batch) {
    for (IdValue i = 0; i < m.segment_end; ++i) {
      if (m.segment(SegmentId{i}).from.is_none()) touch(m, SegmentId{i});
    }
    for (IdValue i = 1; i < m.vertex_end; ++i) {
      Owner& owner = m.owners[i];
      if (owner.role() == Role::fresh) owner = Owner(Role::steiner, owner.segment());
    }
  }
  while (!m.touched.is_none()) {
    const SegmentId s = m.touched;
    m.touched = m.segment(s).next_touched;
    m.segment(s).next_touched = not_listed;
    if (m.segment(s).from.is_none() && !is_free(m, s)) free_segment(m, s);
  }
  m.recycled_segments = SegmentId::none();
}

void restore_detached(MeshState& m) noexcept {
  while (!m.detached.is_none()) {
    const VertexId v = m.detached;
    m.detached = VertexId{m.vertex_edges[v.value].value};
    m.owner(v) = Owner(Role::steiner, m.owner(v).segment());
    ++m.steiner_count;
    insert_vertex(m, v, find(m, m.at(v), m.walk_start));
  }
  clear_dirty(m);
  for (SegmentId s = m.touched; !s.is_none(); s = m.segment(s).next_touched) {
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
  end_change(m);
}

void commit(MeshState& m) noexcept {
  while (!m.detached.is_none()) {
    const VertexId v = m.detached;
    m.detached = VertexId{m.vertex_edges[v.value].value};
    free_vertex(m, v);
  }
  prune(m);
  end_change(m);
}

}  // namespace etcm::internal
