#include "triangulation/change.h"

#include <utility>

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
