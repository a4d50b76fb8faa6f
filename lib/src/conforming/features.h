// A feature as a chain of segments.
#pragma once

#include "triangulation/change.h"

namespace etcm::internal {

// Follows the line of a feature that is not linked (its root segment holds its two ends), and says
// whether it may lie there. Errors: crossing_features, overlapping_features, repeated_feature,
// out_of_features; error_detail is set.
struct SurveyResult {
  Status status = Status::ok;
  bool is_present = true;  // every subsegment is an edge or can be one
  std::uint32_t nodes_between = 0;
};
SurveyResult survey(MeshState& m, SegmentId root) noexcept;
// Links it: one segment from node to node, all of them dirty. After a survey that answered ok.
void link_feature(Change& change, SegmentId root, std::uint32_t nodes_between) noexcept;
// Unlinks it, Steiner vertices and marks included; the recycled segments stay with the root, so
// that linking it again on the same line gives each its old place.
void unlink_feature(Change& change, SegmentId root) noexcept;
// Gives a new root its ends, in canonical direction.
void set_ends(MeshState& m, SegmentId root, VertexId from, VertexId to) noexcept;
FeatureEnds ends_of(const MeshState& m, SegmentId root) noexcept;  // in canonical direction
// For link_feature(), where no survey has counted.
inline constexpr std::uint32_t any_nodes_between = ~std::uint32_t{0};

}  // namespace etcm::internal
