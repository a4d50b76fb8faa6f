#include "conforming/conform_features.h"

#include "conforming/conform.h"
#include "conforming/features.h"
#include "conforming/prune.h"
#include "triangulation/change.h"
#include "triangulation/mesh_state.h"
#include "triangulation/segment_store.h"

namespace etcm::internal {
namespace {

// A segment's part of sorting them all, and of going over them a few times.
constexpr Units work_of_linking = 32;

// All features are linked before the first is laid: where a policy asks which features meet at a
// node, the answer must not depend on which of them have been laid.
[[gnu::noinline]] Status link_features(Change& change, FeatureList& features,
                                       PendingSegments& pending) noexcept {
  MeshState& m = change.mesh;
  features.sort(m);
  for (FeatureList::Cursor at(m, features); !at.segment().is_none();) {
    const SegmentId root = at.segment();
    const SurveyResult surveyed = survey(m, root);
    if (surveyed.status != Status::ok) return surveyed.status;
    // Each segment is looked for once more now, and on the way back.
    const Units segments = Units{surveyed.nodes_between} + 1;
    m.work.keep(4 * surveyed.steps + 2 * work_of_linking * segments);
    if (!m.work.spend_whole(surveyed.steps + work_of_linking * segments)) return Status::work_limit;
    at.take();
    link_feature(change, root, surveyed.nodes_between);
    for (SegmentId s = root; !s.is_none(); s = m.segment(s).next) pending.push(m, s);
    if (m.work.is_over()) return Status::work_limit;
  }
  return Status::ok;
}

// Two that run along each other lie side by side in canonical order. No later step would see it:
// an edge is known to be that of the first segment found between its ends.
[[gnu::noinline]] Status find_repeated(Change& change, PendingSegments& pending) noexcept {
  MeshState& m = change.mesh;
  SegmentId before{};
  for (PendingSegments::Cursor at(m, pending); !at.segment().is_none(); at.advance()) {
    const SegmentId s = at.segment();
    if (!before.is_none() && !precedes(m, before, s)) return reject_meeting(m, s, before);
    before = s;
  }
  return Status::ok;
}

// What can be an edge as it is. Then no split ignores it.
// Not inline, like find_repeated(), or the deepest call would have the room of this too.
[[gnu::noinline]] Status lay_edges(Change& change, PendingSegments& pending) noexcept {
  MeshState& m = change.mesh;
  for (PendingSegments::Cursor at(m, pending); !at.segment().is_none();) {
    Subsegment whole;
    const Status status = survey_segment(m, at.segment(), whole);
    const bool is_kept = m.work.may_keep(2 * Units{whole.steps});
    if (status != Status::ok) return status;
    if (!is_kept) return Status::work_limit;
    if (can_be_edge(m, whole)) {
      if (!constrain_subsegment(m, whole)) return Status::work_limit;
      at.take();
    } else {
      at.advance();
    }
  }
  return Status::ok;
}

}  // namespace

Status lay_segment(Change& change, SegmentId s) noexcept {
  touch(change, s);
  make_dirty(change, s);
  const Status status = conform(change);
  if (status == Status::ok && change.extent != Change::Extent::local) {
    // Before the next segment: what is needless is in its way too, and takes room.
    if (!prune(change)) return Status::work_limit;
    clear_touched(change);
  }
  return status;
}

Status lay_segments(Change& change, PendingSegments& pending) noexcept {
  MeshState& m = change.mesh;
  pending.sort(m);
  Status status = find_repeated(change, pending);
  if (status == Status::ok) status = lay_edges(change, pending);
  if (change.extent != Change::Extent::local) clear_touched(change);
  while (status == Status::ok && !pending.is_empty()) {
    status = lay_segment(change, pending.pop(m));
  }
  while (!pending.is_empty()) make_dirty(change, pending.pop(m));
  return status == Status::ok && !m.work.fits(0) ? Status::work_limit : status;
}

Status conform_features(Change& change, FeatureList& features) noexcept {
  PendingSegments pending;
  Status status = link_features(change, features, pending);
  if (status == Status::ok) return lay_segments(change, pending);
  pending.clear(change.mesh);
  return status;
}

Status constrain_segment(MeshState& m, SegmentId s) noexcept {
  const VertexId end = m.segment(s).to;
  for (VertexId v = m.segment(s).from; v != end;) {
    const Subsegment subsegment = march(m, v, end, m.work.walk());
    if (!m.work.spend(subsegment.steps)) return Status::work_limit;
    const SegmentId other = met_by(m, s, subsegment);
    if (!other.is_none()) return reject_meeting(m, s, other);
    // A segment ends at each node that it meets; in forged bytes it may go on.
    if (subsegment.tail != end && m.is_node(subsegment.tail)) return Status::damaged;
    if (!can_be_edge(m, subsegment)) return Status::mesh_unresolved;
    if (!constrain_subsegment(m, subsegment)) return Status::work_limit;
    v = subsegment.tail;
  }
  return Status::ok;
}

}  // namespace etcm::internal
