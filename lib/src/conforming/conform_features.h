// Several features or segments at once, each laid in canonical order.
#pragma once

#include "triangulation/change.h"

namespace etcm::internal {

// Links the features, then lays their segments. Those that could not be linked stay in the list.
// Errors: those of survey() and of lay_segments().
Status conform_features(Change& change, FeatureList& features) noexcept;

// Makes segments that are linked, but have no marks and no Steiner vertices yet, unions of edges:
// first those that need no Steiner vertex, then the others one by one, each in canonical order.
// Errors: the room-and-bounds codes, and crossing_features, overlapping_features and
// repeated_feature, with error_detail set; what has not been laid is dirty then.
Status lay_segments(Change& change, PendingSegments& pending) noexcept;

// Makes one segment a union of edges, and those again that it breaks on the way.
Status lay_segment(Change& change, SegmentId s) noexcept;

// Marks the subsegments of a segment that is linked and whose Steiner vertices all stand. Errors:
// work_limit, mesh_unresolved where one cannot be an edge, damaged where a node stands between its
// ends, and those of reject_meeting().
Status constrain_segment(MeshState& m, SegmentId s) noexcept;

}  // namespace etcm::internal
