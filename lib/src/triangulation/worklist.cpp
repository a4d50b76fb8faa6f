#include "triangulation/worklist.h"

#include <utility>

#include "triangulation/mesh_state.h"
#include "triangulation/segment_store.h"

namespace etcm::internal {
namespace {

bool list_touched(MeshState& m, SegmentId s) noexcept {
  SegmentRecord& r = m.segment(s);
  if (r.next_touched != not_listed) return false;
  r.next_touched = m.touched;
  m.touched = s;
  return true;
}

}  // namespace

void touch(MeshState& m, SegmentId s) noexcept {
  list_touched(m, s);
  m.segment(s).first = m.segment(s).last = VertexId::none();
}

void touch(MeshState& m, SegmentId s, VertexId u, VertexId v) noexcept {
  if (m.at(v) < m.at(u)) std::swap(u, v);
  SegmentRecord& r = m.segment(s);
  if (list_touched(m, s) || r.first == infinite_vertex) {
    r.first = u;
    r.last = v;
  } else if (!r.first.is_none()) {
    if (m.at(u) < m.at(r.first)) r.first = u;
    if (m.at(r.last) < m.at(v)) r.last = v;
  }
}

void make_dirty(MeshState& m, SegmentId s) noexcept {
  if (m.segment(s).next_dirty != not_listed) return;
  // Kept in canonical order: in which order the mesh's triangles happened to break them must not
  // show in the result. The list is short.
  SegmentId* slot = &m.dirty;
  while (!slot->is_none() && precedes(m, *slot, s)) slot = &m.segment(*slot).next_dirty;
  m.segment(s).next_dirty = *slot;
  *slot = s;
}

SegmentId pop_dirty(MeshState& m) noexcept {
  const SegmentId s = m.dirty;
  if (s.is_none()) return s;
  m.dirty = m.segment(s).next_dirty;
  m.segment(s).next_dirty = not_listed;
  return s;
}

void clear_dirty(MeshState& m) noexcept {
  while (!pop_dirty(m).is_none()) {
  }
}

SegmentId sort_segments(MeshState& m, SegmentId list) noexcept {
  // Bottom-up: runs of 1, 2, 4, ... are merged pairwise until one is left. No recursion, no memory.
  const auto next = [&m](SegmentId s) -> SegmentId& { return m.segment(s).next_dirty; };
  for (std::uint32_t run = 1;; run *= 2) {
    SegmentId rest = list;
    SegmentId* end = &list;
    std::uint32_t merges = 0;
    while (!rest.is_none()) {
      ++merges;
      SegmentId a = rest;
      SegmentId b = a;
      std::uint32_t a_left = 0;
      while (a_left < run && !b.is_none()) {
        ++a_left;
        b = next(b);
      }
      std::uint32_t b_left = run;
      while (a_left > 0 || (b_left > 0 && !b.is_none())) {
        const bool take_b = a_left == 0 || (b_left > 0 && !b.is_none() && precedes(m, b, a));
        SegmentId& taken = take_b ? b : a;
        (take_b ? b_left : a_left) -= 1;
        *end = taken;
        SegmentId& link = next(taken);
        taken = link;
        end = &link;
      }
      rest = b;
    }
    *end = SegmentId::none();
    if (merges <= 1) return list;
  }
}

void clear_touched(MeshState& m) noexcept {
  while (!m.touched.is_none()) {
    const SegmentId s = m.touched;
    m.touched = m.segment(s).next_touched;
    m.segment(s).next_touched = not_listed;
  }
}

}  // namespace etcm::internal
