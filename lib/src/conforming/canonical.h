// What of the mesh is as build() makes it. A segment is canonical or stale: its Steiner vertices
// may not be those that build() would make. What a change has touched, and what that can have had
// an influence on, becomes stale.
#pragma once

#include "triangulation/change.h"

namespace etcm::internal {

bool is_stale(const MeshState& m, SegmentId s) noexcept;
// It, and the segments that depend on it.
void make_stale(MeshState& m, SegmentId s) noexcept;
// All are, and nothing is known of what depends on what.
void make_all_stale(MeshState& m) noexcept;
void make_canonical(MeshState& m, SegmentId s) noexcept;
// The place of a segment is given back.
void forget_segment(MeshState& m, SegmentId s) noexcept;

// While segments are laid, a Steiner vertex of one was taken out again that had an influence on the
// other: nothing in the mesh tells of it, but neither is what it is without the other.
void make_dependent(MeshState& m, SegmentId a, SegmentId b) noexcept;
// For find_influenced(), of a Steiner vertex that is taken out again while segments are laid.
void on_dependent(Change& change, SegmentId found, SegmentId about) noexcept;

// A vertex comes or goes there. What it has influence on becomes stale when the mesh is made
// canonical: until then the place is kept, and where there are too many, all is stale.
void note_place(Change& change, const Point& place) noexcept;
// Makes stale what those have influence on. False: the limit of the work does not allow it.
[[nodiscard]] bool look_at_places(Change& change) noexcept;
// The change is taken back.
void forget_places(Change& change) noexcept;

// The mark of an edge between two nodes goes: touches what it has influence on.
void note_mark(Change& change, Edge e) noexcept;
// A segment has been linked or will be unlinked: policies ask which segments meet at its ends.
void note_incidence(Change& change, SegmentId s) noexcept;

}  // namespace etcm::internal
