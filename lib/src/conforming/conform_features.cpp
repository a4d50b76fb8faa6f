#include "conforming/conform_features.h"

#include "conforming/conform.h"
#include "conforming/features.h"
#include "conforming/prune.h"
#include "triangulation/mesh_state.h"
#include "triangulation/worklist.h"

namespace etcm::internal {

Status conform_features(MeshState& m, SegmentId list, SegmentId& pending) noexcept {
  pending = sort_segments(m, list);
  // What is an edge already, or can be by flipping ties, comes first: then no split ignores it.
  for (SegmentId* slot = &pending; !slot->is_none();) {
    const SegmentId root = *slot;
    const SurveyResult surveyed = survey(m, root);
    if (surveyed.status != Status::ok) return surveyed.status;
    if (!surveyed.is_present) {
      slot = &m.segment(root).next_dirty;
      continue;
    }
    *slot = m.segment(root).next_dirty;
    m.segment(root).next_dirty = not_listed;
    link_feature(m, root, surveyed.nodes_between);
    const Status status = conform(m);
    if (status != Status::ok) return status;
  }
  if (m.is_batch) clear_touched(m);
  while (!pending.is_none()) {
    const SegmentId root = pending;
    const SurveyResult surveyed = survey(m, root);
    if (surveyed.status != Status::ok) return surveyed.status;
    pending = m.segment(root).next_dirty;
    m.segment(root).next_dirty = not_listed;
    link_feature(m, root, surveyed.nodes_between);
    const Status status = conform(m);
    if (status != Status::ok) return status;
    // Before the next feature: what is needless is in its way too, and takes room.
    if (m.is_batch) {
      prune(m);
      clear_touched(m);
    }
  }
  return Status::ok;
}

}  // namespace etcm::internal
