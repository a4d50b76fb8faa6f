// A node comes into the mesh or goes out of it, and the features that run through it with it.
#pragma once

#include "triangulation/change.h"
#include "triangulation/segment_list.h"

namespace etcm::internal {

// Says in error_detail what is wrong and with which vertex, and answers with it.
Status report(MeshState& m, Status status, VertexId vertex) noexcept;

// Puts node v, whose point is set, into the mesh, on its segment if it stands on one. `cut` is that
// segment and `rest` its new other part, for remove_node(). `rest` may come with a segment to take.
// Where the answer is not ok, it is not in, and the segment is at most stripped.
Status insert_node(Change& change, VertexId v, SegmentId& cut, SegmentId& rest) noexcept;
// Takes it out again when the change is taken back.
void remove_node(Change& change, VertexId v, SegmentId cut, SegmentId rest) noexcept;

// Whether a feature starts or ends at v.
bool is_endpoint(const MeshState& m, VertexId v) noexcept;
// Unlinks all features that start or end at v. Ends early where there is no room for the work.
FeatureList unlink_features_of(Change& change, VertexId v) noexcept;

// Takes the Steiner vertices off the features that run through v, on both sides. False: there is no
// room for the work.
[[nodiscard]] bool strip_segments_at(Change& change, VertexId v) noexcept;
// Makes those features pass it by: both parts of each become one. The second parts are returned as
// a list, linked by `next`, for split_segments_at().
SegmentId merge_segments_at(Change& change, VertexId v) noexcept;
// Makes them run through it again.
void split_segments_at(MeshState& m, VertexId v, SegmentId parts) noexcept;
// Of a node that is about to go: a node beside it, from which its place is found when it comes
// back, or none, and room for the way. False: there is no room.
[[nodiscard]] bool keep_way_back(Change& change, VertexId v, unsigned degree,
                                 VertexId& beside) noexcept;
// Puts v back where it stood, the segments that passed it by stripped.
void put_node_back(Change& change, VertexId v, SegmentId parts, VertexId beside) noexcept;

}  // namespace etcm::internal
