#include "conforming/group.h"

#include "conforming/canonical.h"
#include "conforming/conform.h"
#include "conforming/conform_features.h"
#include "conforming/detach.h"
#include "conforming/influence.h"
#include "conforming/lone.h"
#include "conforming/transaction.h"
#include "triangulation/change.h"
#include "triangulation/march.h"
#include "triangulation/mesh_state.h"
#include "triangulation/segment_store.h"

namespace etcm::internal {
namespace {

// Work is counted in Steiner vertices that are looked at. To lay one, and to look at it, is twice
// as much; to lay all takes as long as 1.4 for each Steiner vertex and 0.35 for each node. A fifth
// of that may be spent on a group, because what is spent in vain comes on top.
constexpr std::uint32_t work_to_lay = 2;
constexpr std::uint32_t work_least = 40;
constexpr std::uint32_t a_fifth_of_all(const MeshState& m) noexcept {
  return m.node_count / 16 + m.steiner_count / 4;
}

// To look at a segment of usual length, to lay it again, and the same for one that it brings along.
std::uint32_t work_of_usual_segment(const MeshState& m) noexcept {
  const std::uint32_t segments = m.config.features_max - segments_left(m);
  return 2 * (1 + m.steiner_count * (1 + work_to_lay) / segments);
}

bool is_in_group(const MeshState& m, SegmentId s) noexcept {
  const SegmentId next = m.segment(s).next_in_group;
  return next != not_listed && !next.is_none();
}

// It comes with those that depend on it.
void add_to_group(Change& change, SegmentId s) noexcept {
  MeshState& m = change.mesh;
  if (is_in_group(m, s)) return;
  change.has_grown = true;
  for (SegmentId member = s;;) {
    SegmentRecord& r = m.segment(member);
    if (!is_in_group(m, member)) {
      if (r.next_in_group == not_listed) ++m.stale_count;
      r.next_in_group = change.group.first;
      change.group.first = member;
      change.group.work_ahead += change.group.work_of_member;
    }
    member = r.next_dependent;
    if (member == s) return;
  }
}

void on_member(Change& change, SegmentId found, SegmentId) noexcept { add_to_group(change, found); }

template <class Visit>
void for_each(const Change& change, SegmentId first, SegmentId end, Visit visit) noexcept {
  for (SegmentId s = first; s != end;) {
    const SegmentId next = change.mesh.segment(s).next_in_group;
    visit(s);
    s = next;
  }
}

// False: laying all would be less.
bool spend(Change& change, std::uint32_t work) noexcept {
  change.group.work_left -= work < change.group.work_left ? work : change.group.work_left;
  return change.group.work_left != 0;
}

// The same, where what is known to be ahead is counted.
bool is_worth_while(const Change& change) noexcept {
  return change.group.work_ahead < change.group.work_left;
}

// Finds whom a segment that lies in the mesh has an influence on, and who has on it.
bool explore(Change& change, SegmentId s) noexcept {
  MeshState& m = change.mesh;
  const VertexId from = m.segment(s).from, to = m.segment(s).to;
  change.group.work_ahead -= change.group.work_of_member;
  for (VertexId v = from; v != to;) {
    Subsegment subsegment = march(m, v, to, m.work.walk());
    m.work.keep(2 * Units{subsegment.steps});
    if (!m.work.spend(subsegment.steps)) return false;
    if (!subsegment.is_edge) {
      // What was laid has broken it, and has been taken out again.
      if (!constrain_subsegment(m, subsegment)) return false;
      subsegment = march(m, v, to, m.work.whole_walk());
    }
    const VertexId tail = subsegment.tail;
    if (tail != to) change.group.work_ahead += work_to_lay;
    if (!spend(change, 1) || !is_worth_while(change)) return false;
    if (!find_influencing(change, subsegment.edge, s, on_member)) return false;
    if (v == from && tail == to && !find_influenced(change, subsegment.edge, s, on_member))
      return false;
    if (tail != to && !find_influenced(change, tail, s, on_member)) return false;
    v = tail;
  }
  return true;
}

// Until it has no influence on another segment, nor has one on it. `explored` is the first of those
// that are known.
// Not inline, like strip(), or the deepest call would have the room of this too.
[[gnu::noinline]] bool close_group(Change& change, SegmentId& explored) noexcept {
  while (change.group.first != explored) {
    const SegmentId end = explored;
    explored = change.group.first;
    bool is_known = true;
    for_each(change, explored, end,
             [&](SegmentId s) noexcept { is_known = is_known && explore(change, s); });
    if (!is_known) return false;
  }
  return true;
}

[[gnu::noinline]] void strip(Change& change, SegmentId first, SegmentId end) noexcept {
  MeshState& m = change.mesh;
  for_each(change, first, end, [&](SegmentId s) noexcept {
    if (!m.work.is_over()) static_cast<void>(strip_segment(change, s));
    m.segment(s).next_dependent = s;
  });
}

[[gnu::noinline]] void settle_group(Change& change) noexcept {
  MeshState& m = change.mesh;
  for_each(change, change.group.first, end_of_group, [&](SegmentId s) noexcept {
    const VertexId to = m.segment(s).to;
    for (VertexId v = m.segment(s).from; v != to;) {
      const Subsegment subsegment = march(m, v, to, m.work.whole_walk());
      m.work.pass(subsegment.steps);
      v = subsegment.tail;
      if (v != to) m.owner(v) = Owner(Role::steiner, s);
    }
    make_canonical(m, s);
  });
}

void release_group(Change& change) noexcept {
  MeshState& m = change.mesh;
  for_each(change, change.group.first, end_of_group,
           [&](SegmentId s) noexcept { m.segment(s).next_in_group = SegmentId::none(); });
}

}  // namespace

Units work_to_lay_all(const MeshState& m) noexcept {
  // A vertex that is put back, and its subsegments. In rounds of halves that are drawn it turns
  // some four edges in the mean where it turns the most; here is room for twelve, for where a few
  // see a long row of others each, the draw may have them come from far to near.
  constexpr Units work_of_vertex = 192;
  return (work_of_vertex + work_of_listing) * (Units{m.vertex_end} + m.segment_end);
}

bool stays_in_group(Change& change, VertexId v) noexcept {
  MeshState& m = change.mesh;
  const SegmentId own = m.owner(v).segment();
  for (SegmentId s = change.touched; !s.is_none(); s = m.segment(s).next_touched) {
    add_to_group(change, s);
  }
  if (!spend(change, work_to_lay) || !find_influenced(change, v, own, on_member)) {
    change.group.work_left = 0;
  }
  return !change.has_grown && change.group.work_left != 0;
}

Status lay_group_again(Change& change, SegmentId stale, bool& is_too_wide) noexcept {
  MeshState& m = change.mesh;
  change.group.first = end_of_group;
  change.group.work_left = a_fifth_of_all(m) + work_least;
  change.group.work_of_member = work_of_usual_segment(m);
  add_to_group(change, stale);
  SegmentId explored = end_of_group;
  Status status = Status::ok;
  bool is_stripped = false;
  for (;;) {
    const SegmentId known = explored;
    is_too_wide = change.group.work_left == 0 || !close_group(change, explored);
    if (m.work.is_over() || (is_too_wide && !m.work.fits(work_to_lay_all(m)))) {
      is_too_wide = false;
      break;
    }
    if (is_too_wide) {
      clear_touched(change);
      release_group(change);
      change.extent = Change::Extent::whole;
      return Status::ok;
    }
    strip(change, change.group.first, known);
    is_stripped = true;
    clear_touched(change);
    change.has_grown = false;
    if (m.work.is_over()) break;
    PendingSegments pending;
    for_each(change, change.group.first, end_of_group,
             [&](SegmentId s) noexcept { pending.push(m, s); });
    status = lay_segments(change, pending);
    if (status == Status::ok) status = lay_lone_again(change);
    if (m.work.is_over() || (change.group.work_left != 0 && !change.has_grown)) break;
    change.dirty.clear(m);
    strip(change, explored, end_of_group);
  }
  if (m.work.is_over()) status = Status::work_limit;
  if (status == Status::ok) {
    settle_group(change);
    return commit(change);
  }
  if (is_stripped) {
    for_each(change, change.group.first, end_of_group,
             [&](SegmentId s) noexcept { touch(change, s); });
  }
  begin_going_back(change, status);
  release_group(change);
  restore_detached(change);
  return status;
}

}  // namespace etcm::internal
