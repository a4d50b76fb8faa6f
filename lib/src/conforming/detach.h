// What a change takes out of the mesh until it succeeds or is undone.
#pragma once

#include "triangulation/change.h"
#include "triangulation/march.h"

namespace etcm::internal {

// The least room a change asks for to take a vertex of this degree out and to put it back. False:
// there is none.
[[nodiscard]] bool may_remove(Change& change, std::uint32_t degree) noexcept;
// Room to find a Steiner vertex again that goes now, and from there the one that went before it.
[[nodiscard]] bool keep_walk_back(Change& change, VertexId v) noexcept;
// The same as may_remove(), and tells the degree. Touches the segments of Steiner vertices next to
// v, which may become needless without it.
[[nodiscard]] bool may_remove_touching(Change& change, VertexId v, unsigned& degree) noexcept;
// Takes a Steiner vertex out of the mesh, to be put back by restore_detached(). False: the limit of
// the work does not allow it; so with the others.
[[nodiscard]] bool detach(Change& change, VertexId steiner) noexcept;
// Room to look for a subsegment again and to mark it, where its head may have more neighbours to
// look at by then than were looked at now. False: there is none, and nothing must be touched.
[[nodiscard]] bool keep_for_mark(MeshState& m, const Subsegment& subsegment) noexcept;
// The same where nothing is kept for the rest of its segment, along which the way to a head with
// many neighbours may be looked for.
[[nodiscard]] bool keep_for_single_mark(MeshState& m, VertexId head) noexcept;
// Detaches all Steiner vertices of a segment (drops the fresh) and takes the marks off its edges.
[[nodiscard]] bool strip_segment(Change& change, SegmentId s) noexcept;
// Takes the mark off a segment that has no Steiner vertices left, if it is marked, without walking
// along it: when a change is taken back. Beforehand there must have been room for that.
[[nodiscard]] bool keep_for_unmarking(MeshState& m, SegmentId s) noexcept;
void unmark_segment(Change& change, SegmentId s) noexcept;
// Drops the fresh Steiner vertices of all touched segments, when the change is taken back.
void drop_fresh(Change& change) noexcept;

}  // namespace etcm::internal
