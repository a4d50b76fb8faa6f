#include "conforming/lone.h"

#include "conforming/canonical.h"
#include "conforming/conform_features.h"
#include "conforming/detach.h"
#include "conforming/influence.h"
#include "triangulation/change.h"
#include "triangulation/march.h"
#include "triangulation/mesh_state.h"
#include "triangulation/segment_store.h"

namespace etcm::internal {
namespace {

// Whether around a Steiner vertex there is neither one of another segment nor a subsegment.
bool stands_alone(MeshState& m, SegmentId s, VertexId v) noexcept {
  const Topology& topo = m.topology;
  Spokes spokes(topo, v, m.work.left());
  bool is_alone = true;
  do {
    const Owner owner = m.owner(spokes.target());
    if (is_in_mesh(owner.role()) && owner.role() != Role::node && owner.segment() != s) {
      is_alone = false;
    }
    if (topo.is_constrained(Topology::next(spokes.edge()))) is_alone = false;
  } while (is_alone && spokes.turn());
  return m.work.spend(spokes.turns()) && is_alone;
}

// One Steiner vertex is the fewest there can be: with none it would be an edge.
bool is_lone(MeshState& m, SegmentId s) noexcept {
  const VertexId to = m.segment(s).to;
  VertexId v = march_counted(m, m.segment(s).from, to);
  if (v == to || !stands_alone(m, s, v)) return false;
  v = march_counted(m, v, to);
  if (v == to) return false;
  for (; v != to; v = march_counted(m, v, to)) {
    if (!stands_alone(m, s, v)) return false;
  }
  return !m.work.is_over();
}

// What stood there may have had an influence on others, and nothing will tell of it.
void note_dependents(Change& change, SegmentId s) noexcept {
  MeshState& m = change.mesh;
  const VertexId to = m.segment(s).to;
  for (VertexId v = march_counted(m, m.segment(s).from, to); v != to; v = march_counted(m, v, to)) {
    if (!find_influenced(change, v, s, on_dependent) && !m.work.is_over()) {
      m.knows_dependence = false;
    }
  }
}

// In canonical order.
void list_lone(Change& change, PendingSegments& lone) noexcept {
  MeshState& m = change.mesh;
  const auto list = [&](SegmentId s) noexcept {
    if (is_lone(m, s)) lone.push(m, s);
  };
  if (change.extent == Change::Extent::group) {
    for (SegmentId s = change.group.first; s != end_of_group; s = m.segment(s).next_in_group)
      list(s);
  } else {
    for (IdValue i = 0; i < m.segment_end; ++i) {
      m.work.pass_entry(i);
      if (is_linked(m, SegmentId{i})) list(SegmentId{i});
    }
  }
  lone.sort(m);
}

}  // namespace

Status lay_lone_again(Change& change) noexcept {
  MeshState& m = change.mesh;
  PendingSegments pending;
  list_lone(change, pending);
  for (PendingSegments::Cursor at(m, pending); !at.segment().is_none(); at.advance()) {
    note_dependents(change, at.segment());
    if (!m.work.is_over()) static_cast<void>(strip_segment(change, at.segment()));
  }
  clear_touched(change);
  Status status = m.work.is_over() ? Status::work_limit : Status::ok;
  while (status == Status::ok && !pending.is_empty()) {
    change.lone = pending.pop(m);
    status = lay_segment(change, change.lone);
  }
  change.lone = SegmentId::none();
  while (!pending.is_empty()) make_dirty(change, pending.pop(m));
  return status;
}

}  // namespace etcm::internal
