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
// The same where a change takes out a vertex, a mark or a node.
void on_influenced(Change& change, SegmentId found, SegmentId about) noexcept;

// A node that has come is looked at when the mesh is made canonical, or when it goes again, or when
// too many have come.
void note_new_node(Change& change, VertexId node) noexcept;
void forget_new_node(MeshState& m, VertexId node) noexcept;
// Makes stale what new nodes can have had an influence on.
void look_at_new_nodes(Change& change) noexcept;

// Before a change takes out a vertex: touches what it can have had an influence on.
void note_going(Change& change, VertexId v) noexcept;
// The same for the mark of an edge between two nodes, which is to go or has come.
void note_mark(Change& change, Edge e) noexcept;
// A segment has been linked or will be unlinked: policies ask which segments meet at its ends.
void note_incidence(Change& change, SegmentId s) noexcept;

}  // namespace etcm::internal
