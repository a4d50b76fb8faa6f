#include "conforming/conform_features.h"

#include "conforming/conform.h"
#include "conforming/features.h"
#include "conforming/prune.h"
#include "triangulation/change.h"
#include "triangulation/mesh_state.h"

namespace etcm::internal {

Status conform_features(Change& change, FeatureList& features) noexcept {
  MeshState& m = change.mesh;
  features.sort(m);
  // What is an edge already, or can be by flipping ties, comes first: then no split ignores it.
  for (FeatureList::Cursor at(m, features); !at.root().is_none();) {
    const SegmentId root = at.root();
    const SurveyResult surveyed = survey(m, root);
    if (surveyed.status != Status::ok) return surveyed.status;
    if (!surveyed.is_present) {
      at.advance();
      continue;
    }
    at.take();
    link_feature(change, root, surveyed.nodes_between);
    const Status status = conform(change);
    if (status != Status::ok) return status;
  }
  const bool is_whole = change.extent == Change::Extent::whole;
  if (is_whole) clear_touched(change);
  for (FeatureList::Cursor at(m, features); !at.root().is_none();) {
    const SegmentId root = at.root();
    const SurveyResult surveyed = survey(m, root);
    if (surveyed.status != Status::ok) return surveyed.status;
    at.take();
    link_feature(change, root, surveyed.nodes_between);
    const Status status = conform(change);
    if (status != Status::ok) return status;
    // Before the next feature: what is needless is in its way too, and takes room.
    if (is_whole) {
      prune(change);
      clear_touched(change);
    }
  }
  return Status::ok;
}

}  // namespace etcm::internal
