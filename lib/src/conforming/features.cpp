// A feature on its way through the mesh: surveyed, linked as a chain of segments, unlinked again.
#include "conforming/features.h"

#include "conforming/canonical.h"
#include "conforming/conform.h"
#include "conforming/detach.h"
#include "geometry/predicates_inline.h"
#include "triangulation/change.h"
#include "triangulation/march.h"
#include "triangulation/mesh_state.h"
#include "triangulation/segment_store.h"

namespace etcm::internal {
namespace {

Status refuse(MeshState& m, Status status, SegmentId root, SegmentId other) noexcept {
  m.error_detail.status = status;
  m.error_detail.feature = feature_of(m, root);
  m.error_detail.other = feature_of(m, other);
  return status;
}

// The segment of a marked edge; where two stand on it, not the one that is asked for.
SegmentId segment_at(const MeshState& m, Edge e, SegmentId asking) noexcept {
  return segment_of_edge(m, m.topology.origin(e), m.topology.target(e), asking);
}

// What is wrong with a feature that meets a part of another.
Status fault_of(const MeshState& m, SegmentId root, SegmentId other) noexcept {
  const FeatureEnds ours = ends_of(m, root);
  const FeatureEnds theirs = ends_of(m, SegmentId{feature_of(m, other).value});
  if (theirs.from == ours.from && theirs.to == ours.to) return Status::repeated_feature;
  const Point &from = m.at(ours.from), &to = m.at(ours.to);
  const bool is_along = orient2d_fast(from, to, m.at(theirs.from)) == 0 &&
                        orient2d_fast(from, to, m.at(theirs.to)) == 0;
  return is_along ? Status::overlapping_features : Status::crossing_features;
}

SegmentId last_segment(const MeshState& m, SegmentId root) noexcept {
  SegmentId s = root;
  while (!m.segment(s).next.is_none()) s = m.segment(s).next;
  return s;
}

// The first of the segments that an earlier lay left, or a new one. There is room: the survey saw.
SegmentId next_segment_for(MeshState& m, SegmentId& left_over) noexcept {
  if (left_over.is_none()) return allocate_segment(m);
  const SegmentId s = left_over;
  left_over = m.segment(s).next;
  return s;
}

// The segments that unlink_feature() kept for this root: those it last used, then those that were
// recycled.
SegmentId collect_left_over(Change& change, SegmentId root) noexcept {
  MeshState& m = change.mesh;
  SegmentId first = m.segment(root).next;
  SegmentId* end = &first;
  while (!end->is_none()) end = &m.segment(*end).next;
  for (SegmentId* slot = &change.recycled_segments; !slot->is_none();) {
    const SegmentId s = *slot;
    if (feature_of(m, s) == feature_of(m, root)) {
      *slot = m.segment(s).next;
      m.segment(s).next = SegmentId::none();
      *end = s;
      end = &m.segment(s).next;
    } else {
      slot = &m.segment(s).next;
    }
  }
  return first;
}

}  // namespace

SegmentId met_by(const MeshState& m, SegmentId s, const Subsegment& subsegment) noexcept {
  if (subsegment.is_edge && m.topology.is_constrained(subsegment.edge)) {
    return segment_at(m, subsegment.edge, s);
  }
  if (!subsegment.constrained.is_none()) return segment_at(m, subsegment.constrained, s);
  const Owner owner = m.owner(subsegment.tail);
  return owner.role() == Role::node || owner.segment() == s ? SegmentId::none() : owner.segment();
}

FeatureEnds ends_of(const MeshState& m, SegmentId root) noexcept {
  // One that is not linked holds its ends itself.
  return {m.segment(root).from, m.segment(is_linked(m, root) ? last_segment(m, root) : root).to};
}

void set_ends(MeshState& m, SegmentId root, VertexId from, VertexId to) noexcept {
  SegmentRecord& r = m.segment(root);
  const bool reversed = m.at(to) < m.at(from);
  r.from = reversed ? to : from;
  r.to = reversed ? from : to;
  r.root = static_cast<IdValue>(root.value | (reversed ? reversed_bit : 0u));
}

SurveyResult survey(MeshState& m, SegmentId root) noexcept {
  const SegmentRecord& r = m.segment(root);
  SurveyResult surveyed;
  std::uint32_t& nodes_between = surveyed.nodes_between;
  for (VertexId v = r.from; v != r.to;) {
    const Subsegment subsegment = march(m, v, r.to, m.work.walk());
    surveyed.steps += subsegment.steps;
    if (!m.work.spend(subsegment.steps)) {
      surveyed.status = refuse(m, Status::work_limit, root, SegmentId::none());
      return surveyed;
    }
    const SegmentId other = met_by(m, root, subsegment);
    if (!other.is_none()) {
      surveyed.status = reject_meeting(m, root, other);
      return surveyed;
    }
    v = subsegment.tail;
    if (v != r.to) ++nodes_between;
  }
  std::uint32_t room = segments_left(m);
  for (SegmentId s = r.next; !s.is_none() && room < nodes_between; s = m.segment(s).next) ++room;
  if (room < nodes_between) {
    surveyed.status = refuse(m, Status::out_of_features, root, SegmentId::none());
  }
  return surveyed;
}

Status survey_segment(MeshState& m, SegmentId s, Subsegment& first) noexcept {
  first = march(m, m.segment(s).from, m.segment(s).to, m.work.walk());
  if (!m.work.spend(first.steps)) return refuse(m, Status::work_limit, s, SegmentId::none());
  const SegmentId other = met_by(m, s, first);
  if (other.is_none()) return Status::ok;
  return reject_meeting(m, s, other);
}

Status reject_meeting(MeshState& m, SegmentId s, SegmentId other) noexcept {
  const SegmentId root{feature_of(m, s).value};
  return refuse(m, fault_of(m, root, other), root, other);
}

void link_feature(Change& change, SegmentId root, std::uint32_t nodes_between) noexcept {
  MeshState& m = change.mesh;
  SegmentId left_over = collect_left_over(change, root);
  m.segment(root).next = SegmentId::none();
  const VertexId end = m.segment(root).to;
  link_segment(m, root);
  SegmentId s = root;
  VertexId v = m.segment(root).from;
  for (; nodes_between != 0; --nodes_between) {
    v = march(m, v, end, m.work.whole_walk()).tail;
    if (v == end) break;
    const SegmentId rest = next_segment_for(m, left_over);
    touch(change, rest);
    cut_segment(m, s, v, rest);
    touch(change, s);
    note_incidence(change, s);
    s = rest;
  }
  touch(change, s);
  note_incidence(change, s);
  // In the order in which they were used: the next lay on the old line gives each its old place.
  SegmentId* end_of_spare = &left_over;
  while (!end_of_spare->is_none()) end_of_spare = &m.segment(*end_of_spare).next;
  *end_of_spare = change.recycled_segments;
  change.recycled_segments = left_over;
}

bool unlink_feature(Change& change, SegmentId root) noexcept {
  MeshState& m = change.mesh;
  const VertexId to = ends_of(m, root).to;
  // As long as all are linked, it is enough to put back what stood on them.
  for (SegmentId s = root; !s.is_none(); s = m.segment(s).next) {
    if (!strip_segment(change, s)) return false;
    note_incidence(change, s);
    if (!m.work.spend_whole(2)) return false;
  }
  for (SegmentId s = root; !s.is_none(); s = m.segment(s).next) {
    unlink_segment(m, s);
    if (s != root) m.segment(s).from = VertexId::none();
  }
  m.segment(root).to = to;
  return true;
}

}  // namespace etcm::internal
