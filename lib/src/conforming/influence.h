// How far a vertex can have an influence: on which segments the presence of a vertex can change
// what is read when they are laid.
//
// Laying a segment reads triangles whose circles touch its line. A vertex p changes one of them
// only if some circle through p, empty of nodes, touches that line; and the empty circles through p
// are those of its star. lib/docs/one-mesh.md has the proof, and why it is enough to ask in the
// mesh as it stands, Steiner vertices included.
#pragma once

#include "triangulation/change.h"

namespace etcm::internal {

// Called for each segment that is found, perhaps more than once; never for `about` itself.
using OnSegment = void (*)(Change& change, SegmentId found, SegmentId about) noexcept;

// The segments on which the vertex has an influence: circles of its star touch their lines. False:
// there is too much to look at. O(the triangles that those circles touch), at most a bound for each
// triangle of the star.
bool find_influenced(Change& change, VertexId v, SegmentId about, OnSegment found) noexcept;
// The same of a vertex that would stand at the place, or does.
bool find_influenced(Change& change, const Point& place, OnSegment found) noexcept;
// The same for the mark of an edge: the lines that the circles on both sides of it touch.
bool find_influenced(Change& change, Edge e, SegmentId about, OnSegment found) noexcept;
// The segments whose Steiner vertices have an influence on a subsegment, an edge of the mesh.
bool find_influencing(Change& change, Edge e, SegmentId about, OnSegment found) noexcept;

}  // namespace etcm::internal
