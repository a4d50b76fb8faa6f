#include "conforming/canonical.h"

#include "conforming/influence.h"
#include "triangulation/change.h"
#include "triangulation/mesh_state.h"
#include "triangulation/segment_store.h"

namespace etcm::internal {
namespace {

// At a node where no more meet, all of them count as concerned.
constexpr unsigned few_segments = 8;

bool has_few_segments(const MeshState& m, VertexId node) noexcept {
  unsigned count = 0;
  for (SegmentId s = m.owner(node).segment(); !s.is_none(); s = next_at(m, s, node)) {
    if (++count > few_segments) return false;
  }
  return true;
}

// Lists a segment as touched, though nothing of it is.
void list(Change& change, SegmentId s) noexcept {
  if (change.mesh.segment(s).next_touched != not_listed) return;
  touch(change, s);
  leave_untouched(change.mesh, s);
}

// `about` is linked or about to be unlinked.
void on_touched_at_ends(Change& change, SegmentId found, SegmentId about) noexcept {
  const SegmentRecord& r = change.mesh.segment(found);
  const SegmentRecord& s = change.mesh.segment(about);
  if (r.from == s.from || r.from == s.to || r.to == s.from || r.to == s.to) list(change, found);
}

void on_touched(Change& change, SegmentId found, SegmentId) noexcept { list(change, found); }

// What is taken back leaves nothing stale, and there is no room for the work to look.
bool tells_of_changes(const Change& change) noexcept {
  const MeshState& m = change.mesh;
  return change.extent == Change::Extent::local && !m.is_all_stale && !m.work.is_going_back();
}

void on_stale(Change& change, SegmentId found, SegmentId) noexcept {
  make_stale(change.mesh, found);
}

}  // namespace

bool is_stale(const MeshState& m, SegmentId s) noexcept {
  return m.is_all_stale || m.segment(s).next_in_group != not_listed;
}

void make_stale(MeshState& m, SegmentId s) noexcept {
  if (!m.knows_dependence) make_all_stale(m);
  for (SegmentId member = s;;) {
    SegmentRecord& r = m.segment(member);
    const SegmentId next = r.next_dependent;
    r.next_dependent = member;
    if (r.next_in_group == not_listed) {
      r.next_in_group = SegmentId::none();
      ++m.stale_count;
    }
    if (next == s) return;
    member = next;
  }
}

void make_all_stale(MeshState& m) noexcept { m.is_all_stale = m.feature_count != 0; }

void make_canonical(MeshState& m, SegmentId s) noexcept {
  SegmentId& state = m.segment(s).next_in_group;
  if (state != not_listed) --m.stale_count;
  state = not_listed;
}

void forget_segment(MeshState& m, SegmentId s) noexcept {
  make_stale(m, s);
  make_canonical(m, s);
}

// Each ring is walked while the other is, so this takes as long as the shorter one.
void make_dependent(MeshState& m, SegmentId a, SegmentId b) noexcept {
  SegmentId in_a = m.segment(a).next_dependent, in_b = m.segment(b).next_dependent;
  while (in_a != a && in_b != b) {
    if (in_a == b || in_b == a || !m.work.spend_whole(1)) return;
    in_a = m.segment(in_a).next_dependent;
    in_b = m.segment(in_b).next_dependent;
  }
  const SegmentId after_a = m.segment(a).next_dependent;
  m.segment(a).next_dependent = m.segment(b).next_dependent;
  m.segment(b).next_dependent = after_a;
}

void on_dependent(Change& change, SegmentId found, SegmentId about) noexcept {
  make_dependent(change.mesh, found, about);
}

void note_place(Change& change, const Point& place) noexcept {
  MeshState& m = change.mesh;
  if (change.extent != Change::Extent::local || m.is_all_stale || m.feature_count == 0) return;
  if (m.place_count == places_most) {
    make_all_stale(m);
  } else {
    m.places[m.place_count++] = place;
  }
}

bool look_at_places(Change& change) noexcept {
  MeshState& m = change.mesh;
  for (; m.place_count != 0 && !m.is_all_stale; --m.place_count) {
    const bool is_known = find_influenced(change, m.places[m.place_count - 1], on_stale);
    if (m.work.is_over()) return false;
    if (!is_known) make_all_stale(m);
  }
  m.place_count = 0;
  return true;
}

void forget_places(Change& change) noexcept {
  MeshState& m = change.mesh;
  m.place_count = change.places_before;
  m.is_all_stale = change.was_all_stale;
}

void note_mark(Change& change, Edge e) noexcept {
  MeshState& m = change.mesh;
  if (!tells_of_changes(change)) return;
  if (!find_influenced(change, e, SegmentId::none(), on_touched)) make_all_stale(m);
}

void note_incidence(Change& change, SegmentId s) noexcept {
  MeshState& m = change.mesh;
  if (!tells_of_changes(change)) return;
  const VertexId from = m.segment(s).from, to = m.segment(s).to;
  for (const VertexId node : {from, to}) {
    if (has_few_segments(m, node)) {
      for (SegmentId x = m.owner(node).segment(); !x.is_none(); x = next_at(m, x, node)) {
        list(change, x);
      }
      continue;
    }
    // Who asks for this segment at the node sees its other end.
    const VertexId other = node == from ? to : from;
    if (!find_influenced(change, other, s, on_touched_at_ends)) make_all_stale(m);
  }
}

}  // namespace etcm::internal
