// The inside of a mesh, shared by the algorithms and opened to tests.
#pragma once

#include <cstddef>
#include <span>

#include "check.h"
#include "etcm/locate.h"
#include "etcm/mesh.h"
#include "etcm/split_site.h"
#include "segments.h"
#include "topology.h"

namespace etcm::internal {

// See hints.cpp.
struct Hints {
  VertexId* nodes = nullptr;  // by cell
  Point low;
  int cell_bits = 0;  // a cell is 2^cell_bits sub-units wide
  int side_bits = 0;  // there are 2^side_bits by 2^side_bits of them
};

inline constexpr std::size_t bytes_per_vertex_triangles = 2 * sizeof(TriangleRecord);

// Lives at the head of the caller's storage, the arrays behind it.
struct MeshState {
  MeshConfig config;
  Topology topology;
  Point* points = nullptr;            // by vertex
  Owner* owners = nullptr;            // by vertex
  Edge* vertex_edges = nullptr;       // by vertex; free and detached vertices: their list
  SegmentRecord* segments = nullptr;  // by segment
  std::byte* triangle_memory = nullptr;

  IdValue vertex_end = 1;  // ids from here on were never used
  IdValue segment_end = 0;
  VertexId free_vertices{};
  SegmentId free_segments{};
  std::uint32_t free_segment_count = 0;

  std::uint32_t node_count = 0;
  std::uint32_t steiner_count = 0;
  std::uint32_t feature_count = 0;
  std::uint32_t unresolved = 0;
  VertexId only_vertex{};  // the only vertex of a mesh of one, which has no triangle

  Hints hints;

  SegmentId dirty{};              // segments with missing subsegments, in canonical order
  SegmentId touched{};            // segments the running change has touched
  VertexId detached{};            // vertices it has taken out
  SegmentId recycled_segments{};  // segments that features have left over while it runs
  std::uint32_t steps = 0;        // it has spent
  bool is_batch = false;          // it links all features, and prunes after each
  Edge walk_start{};              // where it is at work: the next walk starts here
  ErrorDetail error_detail;
  const Mesh* mesh = nullptr;  // for policies

  const Point& at(VertexId v) const noexcept { return points[v.value]; }
  Owner& owner(VertexId v) noexcept { return owners[v.value]; }
  const Owner& owner(VertexId v) const noexcept { return owners[v.value]; }
  SegmentRecord& segment(SegmentId s) noexcept { return segments[s.value]; }
  const SegmentRecord& segment(SegmentId s) const noexcept { return segments[s.value]; }
  std::uint32_t vertex_count() const noexcept { return node_count + steiner_count; }
  bool is_node(VertexId v) const noexcept {
    return v.value < vertex_end && owner(v).role() == Role::node;
  }
};

// --- locate.cpp

struct Found {
  Place place = Place::outside;
  Edge edge{};        // inside: an edge of the triangle; on_edge: that edge; outside: see below
  VertexId vertex{};  // on_vertex
};

// Where p lies. outside: `edge` is of the ghost whose hull edge p can see; in a collinear mesh that
// p prolongs it is the edge from the end of the chain to infinity; with fewer than two vertices
// none.
Found find(const MeshState& m, const Point& p, Edge near) noexcept;

// True where all vertices are collinear (and there are at least two). O(1).
bool is_flat(const MeshState& m) noexcept;

// --- hints.cpp

// Takes in a node that has joined or come back; forget() before it leaves the triangulation.
void add_hint(MeshState& m, VertexId node) noexcept;
void remove_hint(MeshState& m, VertexId node) noexcept;
// For all nodes at once, and the place of one that has yet to come. O(n).
void spread_hints(MeshState& m, const Point* also) noexcept;
// An edge near p.
Edge edge_near(const MeshState& m, const Point& p) noexcept;

// --- march.cpp: along a straight line through the mesh

// The segment from a vertex to the next vertex on the way to another, in whose direction it looks.
struct Subsegment {
  VertexId head{};
  VertexId tail{};
  bool is_edge = false;
  Edge edge{};         // is_edge: head -> tail
  Edge head_edge{};    // else: opposite head in its triangle that the segment enters, and
  Edge tail_edge{};    // opposite tail in the triangle by which it arrives
  Edge constrained{};  // an edge of a feature that it crosses, if any
};
Subsegment march(const MeshState& m, VertexId head, VertexId toward) noexcept;
// The same where the next vertex is known and the segment is no subsegment: looks at both ends
// only, and at nothing it crosses.
Subsegment between(const MeshState& m, VertexId head, VertexId tail) noexcept;

// --- insert.cpp, remove.cpp, ties.cpp: the canonical triangulation of a changing set

// Puts the vertex (its point is set) where `found` says. Subsegments that are no longer Delaunay
// are broken, and their segments become dirty. Cannot fail.
void insert_vertex(MeshState& m, VertexId v, const Found& found) noexcept;
// Takes the vertex out of the triangulation; its id stays. Edges to it must not be needed.
void remove_vertex(MeshState& m, VertexId v) noexcept;
// The same for a Steiner vertex and its subsegments.
void remove_steiner(MeshState& m, VertexId v) noexcept;
// True where p is in conflict with the ghost behind the hull edge u -> v (to its left): strictly
// outside, or on the edge itself.
bool conflicts_with_ghost(const MeshState& m, VertexId u, VertexId v, const Point& p) noexcept;
// True where p, a new or moved vertex, belongs inside the circle of the triangle beyond e.
bool must_flip(const MeshState& m, Edge e, const Point& p) noexcept;
// Flips the edges that a segment crosses, all of whose ends lie on one empty circle with it, so
// that it becomes an edge; returns it.
Edge flip_in(MeshState& m, const Subsegment& subsegment) noexcept;
// Marks an edge as a subsegment, and brings the ties beside it to their canonical form.
void constrain(MeshState& m, Edge e) noexcept;
// The reverse.
void release_constraint(MeshState& m, Edge e) noexcept;

// --- segments.cpp: the records

VertexId allocate_vertex(MeshState& m) noexcept;  // none: no room
void free_vertex(MeshState& m, VertexId v) noexcept;
SegmentId allocate_segment(MeshState& m) noexcept;  // none: no room
void free_segment(MeshState& m, SegmentId s) noexcept;
// Into and out of the incidence lists of its two ends.
void link_segment(MeshState& m, SegmentId s) noexcept;
void unlink_segment(MeshState& m, SegmentId s) noexcept;
bool is_free(const MeshState& m, SegmentId s) noexcept;
// Whether it is in them: part of a feature that lies in the mesh.
bool is_linked(const MeshState& m, SegmentId s) noexcept;
SegmentId next_at(const MeshState& m, SegmentId s, VertexId node) noexcept;
// The segment that has a subsegment between u and v. O(features at u) if both are nodes, else O(1).
SegmentId segment_of_edge(const MeshState& m, VertexId u, VertexId v) noexcept;
FeatureId feature_of(const MeshState& m, SegmentId s) noexcept;
// Canonical order: by the lexicographically smaller end, then by the greater.
bool precedes(const MeshState& m, SegmentId a, SegmentId b) noexcept;
// The running change may have to put the segment back: all of it, or from u to v.
void touch(MeshState& m, SegmentId s) noexcept;
void touch(MeshState& m, SegmentId s, VertexId u, VertexId v) noexcept;
// Into the list of work, for the part that is touched; and the first of that list.
void make_dirty(MeshState& m, SegmentId s) noexcept;
SegmentId pop_dirty(MeshState& m) noexcept;
void clear_dirty(MeshState& m) noexcept;
// Node v, on segment s, cuts it in two: s ends there and `rest` takes over. And back.
void cut_segment(MeshState& m, SegmentId s, VertexId v, SegmentId rest) noexcept;
void rejoin_segments(MeshState& m, SegmentId s, SegmentId rest) noexcept;

// The place of a parameter on a segment's grid, and the reverse for a vertex on it.
Point point_at(const MeshState& m, SegmentId s, Parameter t) noexcept;
Parameter parameter_of(const MeshState& m, SegmentId s, VertexId v) noexcept;

// --- conform.cpp

// Works off the dirty segments, splitting as config.policy says, until every touched segment is a
// union of edges. Errors: the room-and-bounds codes, crossing_features; error_detail is set.
Status conform(MeshState& m) noexcept;
// True where the subsegment can be an edge by choosing among ties (or is one).
bool can_be_edge(const MeshState& m, const Subsegment& subsegment) noexcept;
// Makes a subsegment that can be an edge a marked edge.
void constrain_subsegment(MeshState& m, const Subsegment& subsegment) noexcept;
// Once conform() has given up: marks the subsegments of dirty segments that can be edges, and
// counts the others.
std::uint32_t constrain_rest(MeshState& m) noexcept;

// --- features.cpp: a feature as a chain of segments

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
void link_feature(MeshState& m, SegmentId root, std::uint32_t nodes_between) noexcept;
// Unlinks it, Steiner vertices and marks included; the recycled segments stay with the root, so
// that linking it again on the same line gives each its old place.
void unlink_feature(MeshState& m, SegmentId root) noexcept;
// Gives a new root its ends, in canonical direction.
void set_ends(MeshState& m, SegmentId root, VertexId from, VertexId to) noexcept;
FeatureEnds ends_of(const MeshState& m, SegmentId root) noexcept;  // in canonical direction
// Links and conforms a list of features (linked by next_dirty), first those that need no Steiner
// vertex, then the others one by one, each in canonical order. Leaves the rest in `pending`.
Status conform_features(MeshState& m, SegmentId list, SegmentId& pending) noexcept;
// Brings a list linked by next_dirty into canonical order.
SegmentId sort_segments(MeshState& m, SegmentId list) noexcept;
// For lay(), where no survey has counted.
inline constexpr std::uint32_t any_nodes_between = ~std::uint32_t{0};

// --- transaction.cpp

void begin(MeshState& m) noexcept;
// Takes a Steiner vertex out of the mesh, to be put back by restore_detached().
void detach(MeshState& m, VertexId steiner) noexcept;
// The segments of Steiner vertices next to v, which may become needless without it.
void touch_around(MeshState& m, VertexId v) noexcept;
// Detaches all Steiner vertices of a segment (drops the fresh) and takes the marks off its edges.
void strip_segment(MeshState& m, SegmentId s) noexcept;
// Drops the fresh Steiner vertices of all touched segments.
void drop_fresh(MeshState& m) noexcept;
// Puts the detached vertices back, marks all touched segments anew and ends the change. The segment
// records must be those of before, and the fresh vertices dropped.
void restore_detached(MeshState& m) noexcept;
// Takes all segments off the list of touched ones.
void clear_touched(MeshState& m) noexcept;
// Prunes needless Steiner vertices of the touched segments, and ends the change.
void commit(MeshState& m) noexcept;
// Forgets the change: what came has come, what was retired and not used again becomes free.
// Whatever a change ends with ends with this, or the next one would take back what was this one's.
void end_change(MeshState& m) noexcept;

// --- prune.cpp

// Takes out the Steiner vertices of the touched segments without which their feature still is a
// union of Delaunay edges, and those of other segments that become needless by that. Never breaks a
// thing.
void prune(MeshState& m) noexcept;

// --- order.cpp

// The order in which build() inserts nodes: along a Hilbert curve. Lives in the part of the
// triangle memory that the growing mesh reaches last, each entry just read before it is
// overwritten.
struct OrderEntry {
  std::uint32_t key;
  std::uint32_t vertex;
};
OrderEntry* hilbert_order(std::span<const Position> nodes, std::byte* memory,
                          std::size_t bytes) noexcept;

}  // namespace etcm::internal

namespace etcm {
inline const internal::MeshState& state_of(const Mesh& mesh) noexcept { return *mesh.state_; }
inline internal::MeshState& state_of(Mesh& mesh) noexcept { return *mesh.state_; }
}  // namespace etcm
