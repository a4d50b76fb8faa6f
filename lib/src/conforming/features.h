// A feature as a chain of segments.
#pragma once

#include "triangulation/change.h"
#include "triangulation/march.h"

namespace etcm::internal {

// Follows the line of a feature that is not linked (its root segment holds its two ends), and says
// whether it may lie there among those that have been laid. Errors: crossing_features,
// overlapping_features, repeated_feature, out_of_features, work_limit; error_detail is set.
struct SurveyResult {
  Status status = Status::ok;
  std::uint32_t nodes_between = 0;
  Units steps = 0;  // triangles and edges on the way
};
SurveyResult survey(MeshState& m, SegmentId root) noexcept;
// The same for a segment that is linked and not laid. `first` is where it leaves its smaller end:
// all of it where the answer is ok.
Status survey_segment(MeshState& m, SegmentId s, Subsegment& first) noexcept;
// The other segment that a subsegment of s, not marked yet, meets: runs along, crosses, or touches
// in one of its Steiner vertices.
SegmentId met_by(const MeshState& m, SegmentId s, const Subsegment& subsegment) noexcept;
// Answers with what is wrong with the feature of a segment that meets another, and sets
// error_detail.
Status reject_meeting(MeshState& m, SegmentId s, SegmentId other) noexcept;
// Links it: one segment from node to node. After a survey that answered ok.
void link_feature(Change& change, SegmentId root, std::uint32_t nodes_between) noexcept;
// Unlinks it, Steiner vertices and marks included; the recycled segments stay with the root, so
// that linking it again on the same line gives each its old place.
// False: the limit of the work does not allow it, and it is linked as before, but stripped in part.
[[nodiscard]] bool unlink_feature(Change& change, SegmentId root) noexcept;
// Gives a new root its ends, in canonical direction.
void set_ends(MeshState& m, SegmentId root, VertexId from, VertexId to) noexcept;
FeatureEnds ends_of(const MeshState& m, SegmentId root) noexcept;  // in canonical direction
// For link_feature(), where no survey has counted.
inline constexpr std::uint32_t any_nodes_between = ~std::uint32_t{0};

}  // namespace etcm::internal
