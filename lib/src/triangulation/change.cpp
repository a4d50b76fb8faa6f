#include "triangulation/change.h"

#include <utility>

#include "triangulation/march.h"
#include "triangulation/mesh_state.h"

namespace etcm::internal {
namespace {

bool list_touched(Change& change, SegmentId s) noexcept {
  SegmentRecord& r = change.mesh.segment(s);
  if (r.next_touched != not_listed) return false;
  r.next_touched = change.touched;
  change.touched = s;
  ++change.touched_count;
  return true;
}

// What lies between two parts that are touched, from u to v, is looked at on the way back, or once
// the change has come to stay: twice, to find what is fresh and to mark it again. It is as it was,
// so each Steiner vertex has its subsegments, by which it is left.
// Not inline: most segments are touched in one place.
[[gnu::noinline]] void keep_between(Change& change, VertexId u, VertexId v) noexcept {
  MeshState& m = change.mesh;
  if (!is_taken_back_whole(change) || m.work.is_going_back()) return;
  while (u != v && m.owner(u).role() != Role::node) {
    const OwnEdges own = own_edges(m, u, m.work.left());
    const std::uint32_t steps = own.looked / marks_a_step + 1;
    if (own.onward.is_none() || !m.work.spend(steps)) return;
    m.work.keep(2 * Units{steps} + 2);
    u = m.topology.target(own.onward);
  }
}

}  // namespace

void touch(Change& change, SegmentId s) noexcept {
  list_touched(change, s);
  SegmentRecord& r = change.mesh.segment(s);
  r.first = r.last = VertexId::none();
}

void touch(Change& change, SegmentId s, VertexId u, VertexId v) noexcept {
  const MeshState& m = change.mesh;
  if (m.at(v) < m.at(u)) std::swap(u, v);
  SegmentRecord& r = change.mesh.segment(s);
  if (list_touched(change, s) || r.first == infinite_vertex) {
    r.first = u;
    r.last = v;
  } else if (!r.first.is_none()) {
    if (m.at(v) < m.at(r.first)) keep_between(change, v, r.first);
    if (m.at(r.last) < m.at(u)) keep_between(change, r.last, u);
    if (m.at(u) < m.at(r.first)) r.first = u;
    if (m.at(r.last) < m.at(v)) r.last = v;
  }
}

void make_dirty(Change& change, SegmentId s) noexcept { change.dirty.add(change.mesh, s); }

void clear_touched(Change& change) noexcept {
  MeshState& m = change.mesh;
  while (!change.touched.is_none()) {
    const SegmentId s = change.touched;
    change.touched = m.segment(s).next_touched;
    m.segment(s).next_touched = not_listed;
  }
  change.touched_count = 0;
}

}  // namespace etcm::internal
