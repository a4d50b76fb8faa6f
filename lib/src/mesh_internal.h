// The inside of a mesh, shared by the algorithms and opened to tests.
#pragma once

#include <cstddef>
#include <span>

#include "check.h"
#include "etcm/locate.h"
#include "etcm/mesh.h"
#include "etcm/split_site.h"
#include "sections.h"
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
  SectionRecord* sections = nullptr;  // by section
  std::byte* triangle_memory = nullptr;

  IdValue vertex_end = 1;  // ids from here on were never used
  IdValue section_end = 0;
  VertexId free_vertices{};
  SectionId free_sections{};
  std::uint32_t free_section_count = 0;

  std::uint32_t node_count = 0;
  std::uint32_t steiner_count = 0;
  std::uint32_t feature_count = 0;
  std::uint32_t unresolved = 0;
  VertexId lone{};  // the only vertex of a mesh of one, which has no triangle

  Hints hints;

  SectionId dirty{};        // sections with missing pieces, in canonical order
  SectionId touched{};      // sections the running change has touched
  VertexId detached{};      // vertices it has taken out
  SectionId spare{};        // sections that features have left over while it runs
  std::uint32_t steps = 0;  // it has spent
  bool is_batch = false;    // it lays all features, and prunes after each
  Edge near{};              // where it is at work: the next walk starts here
  Trouble trouble;
  const Mesh* mesh = nullptr;  // for policies

  const Point& at(VertexId v) const noexcept { return points[v.value]; }
  Owner& owner(VertexId v) noexcept { return owners[v.value]; }
  const Owner& owner(VertexId v) const noexcept { return owners[v.value]; }
  SectionRecord& section(SectionId s) noexcept { return sections[s.value]; }
  const SectionRecord& section(SectionId s) const noexcept { return sections[s.value]; }
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
void remember(MeshState& m, VertexId node) noexcept;
void forget(MeshState& m, VertexId node) noexcept;
// For all nodes at once, and the place of one that has yet to come. O(n).
void spread_hints(MeshState& m, const Point* also) noexcept;
// An edge near p.
Edge edge_near(const MeshState& m, const Point& p) noexcept;

// --- march.cpp: along a straight line through the mesh

// The stretch from a vertex to the next vertex on the way to another, in whose direction it looks.
struct Stretch {
  VertexId head{};
  VertexId tail{};
  bool is_edge = false;
  Edge edge{};         // is_edge: head -> tail
  Edge head_edge{};    // else: opposite head in its triangle that the stretch enters, and
  Edge tail_edge{};    // opposite tail in the triangle by which it arrives
  Edge constrained{};  // an edge of a feature that it crosses, if any
};
Stretch march(const MeshState& m, VertexId head, VertexId toward) noexcept;
// The same where the next vertex is known and the stretch is no subsegment: looks at both ends
// only, and at nothing it crosses.
Stretch between(const MeshState& m, VertexId head, VertexId tail) noexcept;

// --- insert.cpp, remove.cpp, ties.cpp: the canonical triangulation of a changing set

// Puts the vertex (its point is set) where `found` says. Subsegments that are no longer Delaunay
// give way, and their sections become dirty. Cannot fail.
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
// Turns the edges that a stretch crosses, all of whose ends lie on one empty circle with it, so
// that it becomes an edge; returns it.
Edge flip_in(MeshState& m, const Stretch& stretch) noexcept;
// Marks an edge as a subsegment, and brings the ties beside it to their canonical form.
void constrain(MeshState& m, Edge e) noexcept;
// The reverse.
void release_constraint(MeshState& m, Edge e) noexcept;

// --- sections.cpp: the records

VertexId allocate_vertex(MeshState& m) noexcept;  // none: no room
void free_vertex(MeshState& m, VertexId v) noexcept;
SectionId allocate_section(MeshState& m) noexcept;  // none: no room
void free_section(MeshState& m, SectionId s) noexcept;
// Into and out of the incidence lists of its two ends.
void link_section(MeshState& m, SectionId s) noexcept;
void unlink_section(MeshState& m, SectionId s) noexcept;
bool is_free(const MeshState& m, SectionId s) noexcept;
// Whether it is in them: part of a feature that lies in the mesh.
bool is_laid(const MeshState& m, SectionId s) noexcept;
SectionId next_at(const MeshState& m, SectionId s, VertexId node) noexcept;
// The section that has a subsegment between u and v. O(features at u) if both are nodes, else O(1).
SectionId section_of_edge(const MeshState& m, VertexId u, VertexId v) noexcept;
FeatureId feature_of(const MeshState& m, SectionId s) noexcept;
// Canonical order: by the lexicographically smaller end, then by the greater.
bool precedes(const MeshState& m, SectionId a, SectionId b) noexcept;
// The running change may have to put the section back: all of it, or from u to v.
void touch(MeshState& m, SectionId s) noexcept;
void touch(MeshState& m, SectionId s, VertexId u, VertexId v) noexcept;
// Into the list of work, for the part that is touched; and the first of that list.
void make_dirty(MeshState& m, SectionId s) noexcept;
SectionId pop_dirty(MeshState& m) noexcept;
void clear_dirty(MeshState& m) noexcept;
// Node v, on section s, cuts it in two: s ends there and `rest` takes over. And back.
void cut_section(MeshState& m, SectionId s, VertexId v, SectionId rest) noexcept;
void rejoin_section(MeshState& m, SectionId s, SectionId rest) noexcept;

// The place of a parameter on a section's grid, and the reverse for a vertex on it.
Point point_at(const MeshState& m, SectionId s, Parameter t) noexcept;
Parameter parameter_of(const MeshState& m, SectionId s, VertexId v) noexcept;

// --- conform.cpp

// Works off the dirty sections, splitting as config.policy says, until every touched section is a
// union of edges. Errors: the room-and-bounds codes, crossing_features; trouble is set.
Status conform(MeshState& m) noexcept;
// True where the piece can be an edge by choosing among ties (or is one).
bool can_be_edge(const MeshState& m, const Stretch& piece) noexcept;
// Makes a piece that can be an edge a marked edge.
void settle_piece(MeshState& m, const Stretch& piece) noexcept;
// Once conform() has given up: marks the pieces of dirty sections that can be edges, and counts the
// others.
std::uint32_t settle_rest(MeshState& m) noexcept;

// --- features.cpp: a feature as a run of sections

// Follows the line of a feature that is not laid (its root section holds its two ends), and says
// whether it may lie there. Errors: crossing_features, overlapping_features, repeated_feature,
// out_of_features; trouble is set.
struct Course {
  Status status = Status::ok;
  bool is_present = true;  // every piece is an edge or can be one
  std::uint32_t nodes_between = 0;
};
Course survey(MeshState& m, SectionId root) noexcept;
// Lays it: one section from node to node, all of them dirty. After a survey that answered ok.
void lay(MeshState& m, SectionId root, std::uint32_t nodes_between) noexcept;
// Takes it up again, Steiner vertices and marks included; the spare sections stay with the root, so
// that laying it again on the same line gives each its old place.
void take_up(MeshState& m, SectionId root) noexcept;
// Gives a new root its ends, in canonical direction.
void set_ends(MeshState& m, SectionId root, VertexId from, VertexId to) noexcept;
FeatureEnds ends_of(const MeshState& m, SectionId root) noexcept;  // in canonical direction
// Lays and conforms a list of features (linked by next_dirty), first those that need no Steiner
// vertex, then the others one by one, each in canonical order. Leaves the rest in `pending`.
Status conform_features(MeshState& m, SectionId list, SectionId& pending) noexcept;
// Brings a list linked by next_dirty into canonical order.
SectionId sort_sections(MeshState& m, SectionId list) noexcept;
// For lay(), where no survey has counted.
inline constexpr std::uint32_t any_nodes_between = ~std::uint32_t{0};

// --- transaction.cpp

void begin(MeshState& m) noexcept;
// Takes a Steiner vertex out of the mesh, to be put back by restore_detached().
void detach(MeshState& m, VertexId steiner) noexcept;
// The sections of Steiner vertices next to v, which may become needless without it.
void touch_around(MeshState& m, VertexId v) noexcept;
// Detaches all Steiner vertices of a section (drops the fresh) and takes the marks off its edges.
void strip_section(MeshState& m, SectionId s) noexcept;
// Drops the fresh Steiner vertices of all touched sections.
void drop_fresh(MeshState& m) noexcept;
// Puts the detached vertices back, marks all touched sections anew and ends the change. The section
// records must be those of before, and the fresh vertices dropped.
void restore_detached(MeshState& m) noexcept;
// Takes all sections off the list of touched ones.
void forget_touched(MeshState& m) noexcept;
// Prunes needless Steiner vertices of the touched sections, and ends the change.
void commit(MeshState& m) noexcept;
// Forgets the change: what came has come, what was retired and not used again becomes free.
// Whatever a change ends with ends with this, or the next one would take back what was this one's.
void end_change(MeshState& m) noexcept;

// --- prune.cpp

// Takes out the Steiner vertices of the touched sections without which their feature still is a
// union of Delaunay edges, and those of other sections that become needless by that. Never breaks a
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
