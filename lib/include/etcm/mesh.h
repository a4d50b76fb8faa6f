// Mesh: a conforming Delaunay triangulation in caller memory that nodes join, leave and move in.
//
// What always holds between calls
// - The triangulation is THE canonical one of its vertices and subsegments: strict Delaunay, then
//   features win ties, then the lexicographic symbolic perturbation. It does not depend on the
//   order in which anything was given, on the compiler or on the machine. Which Steiner vertices
//   there are does depend on the order of changes, until canonicalize().
// - Each feature is a union of mesh edges, exactly; each Steiner vertex lies exactly on one.
//   (After build() answered steiner_budget, out_of_vertices or grid_exhausted: but for the
//   subsegments that unresolved() counts; two vertices of chain() in a row may have no edge then.)
// - 0, 1, 2 and collinear nodes are meshes too: they have no finite triangle.
//
// Guarantee of every call that changes the mesh: it succeeds whole, or the mesh, its hash included,
// is as it was, and Status says why. (build() may leave a partly conforming mesh, and says so;
// canonicalize() and optimise() keep what they have done, each step of it whole.) As it was: the
// same ids name the same vertices and features, and no other ids are in use. Triangles may have
// other numbers, neighbours() may begin with another, and its bytes are others: where they are
// sealed (storage.h), they want a new seal after each of these calls, whatever it answered.
//
// Ids: the least free id is given out first. A node that joins gets the least id above 0 that no
// vertex has, a feature the least that no feature has, and no segment of one behind its first:
// those take ids of the same kind. So which id comes next can be told from those in use, whatever
// the history, and the same calls on the same mesh give the same ids on every machine, as long as
// they get the same answers: a limit may be enough in one of two meshes that came about in other
// ways, as a loaded one has, and not in the other (docs/work.md). But canonicalize(), rebuild()
// and optimise(): what they lay again goes with the changes that were made before, those aside that
// were refused and dry runs. So after them two meshes that came about in other ways are compared by
// hash(), and ids by where they stand. A Steiner vertex takes the least id
// too, when it comes; while a change is going on, what it has taken out keeps its own. In which
// order Steiner vertices come, and so their ids and those of nodes that join after them, may be
// another in the next version of the library. "Bit for bit" is said of what stands where and of
// what is linked to what: hash(). After canonicalize() the Steiner vertices have other ids than
// after build(), as a rule.
//
// An id that names nothing is data for a change: it answers unknown_vertex or unknown_feature. For
// a question it is a mistake of the program (illegal_argument.h): ask kind() or is_feature()
// before.
//
// Work: each of these calls takes a limit (work.h). One that would need more answers work_limit,
// and what it has done until then, going back included, was within the limit. That holds for work
// that is counted (docs/work.md); work_used() and work_needed() tell of it. Without a limit a call
// always ends, too.
//
// Room: what a change takes out, Steiner vertices and segments of features that turn to another
// line, keeps its place until the change ends. So a full mesh may answer out_of_vertices or
// out_of_features where there would have been room in the end. Then canonicalize() gives back what
// history has left; else fewer features, or storage for more: save(), open() it and load(). Room is
// asked for before most of what may be wrong with the input: a full mesh may answer so, too, where
// a node is in the way or features cross.
//
// Errors: while unresolved() is not 0 each change but clear() answers mesh_unresolved, save() too
// (build(), restore() and load() mesh_not_empty). The room-and-bounds codes are out_of_vertices,
// out_of_features, steiner_budget, work_limit and grid_exhausted.
//
// Threads: none inside; one thread at a time, or any number of readers: what is const writes
// nothing, while a change that is refused and a dry run write, too. Two meshes share nothing, so
// two threads may change one each; handles (handles.h) belong to their mesh. What reads in the
// middle of a change, as an interrupt may, gets answers of no mesh, and may be stopped for it
// (etcm_check_failed); docs/readers.md has ways to read and write at once. Storage need not be
// zeroed, and what was in it is forgotten by open(); what a mesh was is taken up again by attach()
// (storage.h) or load().
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "etcm/config.h"
#include "etcm/status.h"
#include "etcm/types.h"
#include "etcm/work.h"

namespace etcm::internal {
struct MeshState;
struct MeshAccess;
}  // namespace etcm::internal

namespace etcm {
inline namespace ETCM_IDS {

enum class VertexKind : std::uint8_t { none, node, steiner };

struct FeatureEnds {
  VertexId from;
  VertexId to;
};

// What the last change stumbled over: `status` is what it answered, ok where it succeeded, and
// fields that do not apply are none. What only reads, and a dry run, leaves it; open() and clear()
// leave none.
struct ErrorDetail {
  Status status = Status::ok;
  VertexId vertex{};    // the node in the way, or the unknown one
  VertexId rejected{};  // duplicate_vertex in build(): the node that stands there too
  FeatureId feature{};  // the feature that cannot be made (in build(): its index in the input;
                        //   of add_feature() none where it is the new one) or, after work_limit,
                        //   that canonicalize() has got to
  FeatureId other{};    // the feature it crosses, overlaps or repeats (as above)
  Point from{};         // the unresolved subsegment of that feature, for steiner_budget and
  Point to{};           //   grid_exhausted
};

// A Steiner vertex that stood on a feature: its index in the list given beside it, and its place
// (any: restore() refuses what is none on the feature).
struct SteinerPlace {
  std::uint32_t feature = 0;
  Point point;
};

struct Neighbour {
  VertexId vertex;
  bool constrained;  // the edge is part of a feature
};

struct Triangle {
  std::array<VertexId, 3> corner;       // counter-clockwise
  std::array<TriangleId, 3> neighbour;  // [i] is across the edge opposite corner[i]
  std::array<bool, 3> constrained;      // [i]: that edge is part of a feature
  [[nodiscard]] bool is_ghost() const noexcept {
    return corner[0] == infinite_vertex || corner[1] == infinite_vertex ||
           corner[2] == infinite_vertex;
  }
};

class Mesh {
 public:
  // A mesh without storage: open() first. Any other call before that is a programming error
  // (illegal_argument.h).
  Mesh() noexcept = default;
  Mesh(const Mesh&) = delete;
  Mesh& operator=(const Mesh&) = delete;

  // Takes the storage, which must outlive the mesh, be aligned to 8 and have storage_bytes(config)
  // bytes; the mesh in it is empty. Of two Mesh objects on one storage only the one that was opened
  // or attached last may be used, which is not checked. Errors: bad_config, storage_too_small, in
  // this order; then the mesh is what it was before. A pointer to enough bytes that is null or not
  // aligned is a programming error. O(1).
  Status open(std::span<std::byte> storage, const MeshConfig& config) noexcept;

  // Forgets all nodes and features. O(1).
  void clear() noexcept;

  // Builds an empty mesh (node_count() is 0, whatever has been) from nodes and features at once:
  // node i becomes vertex i + 1. Endpoint ids are those vertices. Feature i becomes FeatureId i.
  // O(n log n). Errors in the input leave the mesh empty, with error_detail() naming the culprit;
  // so does work_limit. steiner_budget, grid_exhausted and out_of_vertices during conforming leave
  // the valid Delaunay mesh of what is done; unresolved() counts the rest, at least one, and
  // changes are refused until clear() or open(); it may be read. Built again after that it needs
  // more steiner_max or vertices_max, which open() gives (how much is not known: twice as much), or
  // fewer features; after grid_exhausted not that feature, or nodes farther apart (error_detail()).
  // So a mesh is whole, and may be changed, exactly while unresolved() is 0. Subsegments that were
  // not made are not compared with each other: features that cross or overlap there, and nowhere
  // else, may not be named. `nodes_stand`, where given, is called with `context` between the nodes,
  // which are a Delaunay mesh by then, and the first feature: for who measures both. It must not
  // use the mesh. Errors: mesh_not_empty; in the input bad_coordinate, duplicate_vertex,
  // unknown_vertex, zero_length_feature, repeated_feature, overlapping_features, crossing_features,
  // out_of_features, and out_of_vertices where there are more nodes than vertices_max; and the
  // room-and-bounds codes.
  Status build(std::span<const Position> nodes, std::span<const FeatureEnds> features,
               Work limit = Work::unlimited(),
               void (*nodes_stand)(void* context) noexcept = nullptr,
               void* context = nullptr) noexcept;

  // Makes an empty mesh what another one was, hash included: its nodes and features, given as for
  // build(), and its Steiner vertices. Splits nothing. Whatever is wrong leaves the mesh empty.
  // Errors: mesh_not_empty, and those of build() for its input; bad_coordinate or duplicate_vertex
  // where a Steiner vertex stands at no place for one on its feature, unknown_feature where that is
  // none of them, mesh_unresolved where a feature would not be a union of edges, and steiner_budget
  // and out_of_vertices where they are too many; work_limit. O(n log n).
  Status restore(std::span<const Position> nodes, std::span<const FeatureEnds> features,
                 std::span<const SteinerPlace> steiner, Work limit = Work::unlimited()) noexcept;

  // The bytes that save() writes: 48, 8 for each vertex id and 16 for each segment of a feature
  // that has been in use at once; at most saved_bytes_most() of its capacities (config.h).
  [[nodiscard]] std::size_t saved_bytes() const noexcept;

  // Writes the mesh, for a file, a radio or flash: what cannot be told from the rest is left out,
  // and every machine writes the same bytes. Every later version of the library loads what this one
  // saves; an older one may answer wrong_version. The first saved_bytes() of the span are written.
  // Errors: buffer_too_small, mesh_unresolved; then nothing is. O(n).
  Status save(std::span<std::byte> out) const noexcept;

  // Makes an empty mesh what save() has written, in this version of the library or any before it
  // from 0.1 on, on this machine or another, with any width of ids:
  // the same nodes, features and Steiner vertices with the same ids, the same hash, and the same
  // ids for who comes next. It need not have the same capacities. Bytes behind what was saved are
  // not looked at. Nothing in the bytes is believed: whatever they are, the mesh is whole, or empty
  // as after restore(). Nothing is known of what was canonical. Errors: mesh_not_empty, not_a_mesh,
  // wrong_version; damaged where they are cut off, altered or contradict themselves;
  // out_of_vertices and out_of_features where an id is beyond the capacities, steiner_budget,
  // work_limit. O(n log n).
  Status load(std::span<const std::byte> saved, Work limit = Work::unlimited()) noexcept;

  // Makes the mesh, whatever its history, the one that build() makes of the same nodes and
  // features, bit for bit. Changes keep the mesh conforming at once, with Steiner vertices that
  // depend on what was there before; this takes them back. Lays again what the changes can have had
  // an influence on, group by group of features that depend on each other; the cost goes with
  // those. After many changes it can be more than that of rebuild(): in what was tried up to three
  // times, and five with fewer than a hundred nodes (docs/one-mesh.md). Between groups the mesh is
  // whole: work_limit leaves what has been done, and the next call goes on, where its limit is
  // enough for one group: error_detail().feature is one of the first that was not. Named twice in a
  // row, with no change in between, the limit is too little for its group but for rare cases, in
  // which some calls more end: give a larger one. None is named before it is known where the groups
  // begin, which takes sixteen calls or so: none seventeen times in a row asks for the same.
  // Errors: mesh_unresolved, and the room-and-bounds codes: build() would answer the same, or the
  // mesh has no room for the old and the new vertices of a group at once.
  Status canonicalize(Work limit = Work::unlimited()) noexcept;
  // Whether it is known to be that mesh: canonicalize() would change nothing.
  [[nodiscard]] bool is_canonical() const noexcept;

  // Drops every Steiner vertex and conforms afresh: what canonicalize() comes to, however much is
  // to be done. O(n log n), as build(). All or nothing; a mesh that is_canonical() stays as it is.
  // Errors: those of canonicalize(), of all segments as one group: it needs room for the old and
  // the new Steiner vertices at once.
  Status rebuild(Work limit = Work::unlimited()) noexcept;

  // Looks for fewer Steiner vertices: each trial lays a few that stand together in another way, and
  // keeps it where it needs no more of them. Never worse, so a few trials now and a few later are
  // well; each trial has a number and does something else than those with others, so later ones go
  // on from `first_trial`. The same calls on the same canonical mesh make the same mesh, whatever
  // the ids, the history and the machine; but it is no longer the one that build() makes, and
  // canonicalize() takes it all back. O(f log f) for f features, and for each trial what laying
  // some 8 Steiner vertices takes, and taking it back. A trial needs room for up to 19 more
  // vertices, and is without effect where there is none. Errors: mesh_unresolved; work_limit, and
  // what has been found by then stays: go on with `first_trial + trials`, for a trial that was left
  // out is no loss.
  Status optimise(std::uint32_t trials, std::uint32_t first_trial = 0,
                  Work limit = Work::unlimited()) noexcept;

  // A node joins. It may stand on a Steiner vertex (and takes its place), on a feature (which then
  // runs through it), on the hull or outside. Sets `id` on success only.
  // Errors: bad_coordinate, duplicate_vertex (error_detail().vertex), and the room-and-bounds
  // codes. Expected O(1) for nodes spread evenly, to find the place as well as to change it.
  Status join(Position position, VertexId& id, Work limit = Work::unlimited()) noexcept;

  // A node leaves. Expected O(its degree), and what its features need anew. Errors: unknown_vertex,
  // endpoint_in_use, crossing_features (two features met there), and the room-and-bounds codes but
  // out_of_features (the feature that ran through it may need more Steiner vertices without it).
  Status leave(VertexId node, Work limit = Work::unlimited()) noexcept;

  // A node moves and keeps its id, and the features that end at it follow it; one that runs through
  // it stays where it is, and no longer runs through it unless it stands on the line still. As
  // leave() and join(), and add_feature() for each feature that follows. Errors: unknown_vertex,
  // bad_coordinate, duplicate_vertex, overlapping_features, crossing_features, and the
  // room-and-bounds codes.
  Status move(VertexId node, Position position, Work limit = Work::unlimited()) noexcept;

  // Adds a feature between two nodes and makes it a union of mesh edges. Sets `id` on success only.
  // Features may share a node, at their ends or on the way: who wants one to end on another (a
  // T-junction), or two to cross, lets a node join there first, exactly on the line. Where lines
  // cross between units there is no such place: round it, and let each be two features that end at
  // the node there; they bend by less than a unit.
  // O(the edges that it crosses) and an insertion for each Steiner vertex, those of features that
  // must give way included.
  // Errors: unknown_vertex, zero_length_feature, repeated_feature, overlapping_features,
  // crossing_features, and the room-and-bounds codes.
  Status add_feature(FeatureEnds ends, FeatureId& id, Work limit = Work::unlimited()) noexcept;

  // Removes a feature and its Steiner vertices. O(their degrees, and features at its ends). Errors:
  // unknown_feature, work_limit.
  Status remove_feature(FeatureId feature, Work limit = Work::unlimited()) noexcept;

  // The function that each of these calls, and each that reads much, calls from time to time while
  // it goes on (work.h), until another is given; {} for none. It is the Mesh's, not the storage's:
  // open() keeps it, and it may be given before. Where several threads read one mesh, each calls
  // it.
  void keep_alive(const KeepAlive& hook) noexcept;

  // What the last of these calls has done, going back included.
  [[nodiscard]] Work work_used() const noexcept;
  // The least limit with which it succeeds, where it has: what it has done, and the room that it
  // kept for going back. Where it was refused the same as work_used(), which is no limit to try:
  // after work_limit the way on is a greater one, or none and keep_alive(). With the same it is
  // refused again, as a rule; canonicalize() goes on.
  [[nodiscard]] Work work_needed() const noexcept;

  // Counts. O(1), but finite_triangle_count(): O(hull).
  [[nodiscard]] MeshConfig config() const noexcept;
  [[nodiscard]] std::uint32_t node_count() const noexcept;
  [[nodiscard]] std::uint32_t steiner_count() const noexcept;
  [[nodiscard]] std::uint32_t feature_count() const noexcept;
  [[nodiscard]] std::uint32_t triangle_count()
      const noexcept;  // ghosts included; ids run below this
  [[nodiscard]] std::uint32_t finite_triangle_count() const noexcept;
  [[nodiscard]] std::uint32_t unresolved()
      const noexcept;  // subsegments of features that are no edges
  // Every vertex id in use is below this, every feature id below the next. Ids between may be free.
  [[nodiscard]] std::uint32_t vertex_id_end() const noexcept;
  [[nodiscard]] std::uint32_t feature_id_end() const noexcept;
  [[nodiscard]] const ErrorDetail& error_detail() const noexcept;

  // Vertices. The id must be below vertex_id_end(), and in use for all but kind(), else it is a
  // programming error; so with the ids below. O(1) each but neighbours().
  [[nodiscard]] VertexKind kind(VertexId vertex) const noexcept;
  [[nodiscard]] Point point(VertexId vertex) const noexcept;
  // Where a node stands, in units. Of a Steiner vertex, which stands between units as a rule, what
  // is behind the point is cut off: of one ask point().
  [[nodiscard]] Position position(VertexId node) const noexcept;
  // The feature a Steiner vertex stands on. Of a node it answers any value, which means nothing
  // and is no error: see features_at(). Where it stands there: point() is the place, exactly on the
  // line; chain() has the order; the share of the way is (point - from) / (to - from) for the ends
  // in sub-units, of x or of y, whichever differs more.
  [[nodiscard]] FeatureId feature_of(VertexId steiner) const noexcept;
  // Writes the neighbours counter-clockwise, the vertex at infinity left out, as many as fit, and
  // returns how many there are: less than 6 on average, and of one vertex as many as there are
  // others at the most: a list for vertices_max - 1 is never too short. O(degree).
  [[nodiscard]] std::uint32_t neighbours(VertexId vertex, std::span<Neighbour> out) const noexcept;

  // Triangles. The id must be below triangle_count().
  [[nodiscard]] Triangle triangle(TriangleId id) const noexcept;

  // Features. The id must be in use for all but is_feature().
  [[nodiscard]] bool is_feature(FeatureId feature) const noexcept;
  [[nodiscard]] FeatureEnds ends(FeatureId feature) const noexcept;
  // Writes the vertices along the feature from ends().from to ends().to, as many as fit, and
  // returns how many there are. O(their degrees).
  [[nodiscard]] std::uint32_t chain(FeatureId feature, std::span<VertexId> out) const noexcept;

  // A number of the triangulation alone: the same for the same vertices, edges and subsegments,
  // whatever the ids, the history and the machine. O(n). Between versions of the library compare it
  // only where the changelog's part on formats is silent: the number of a triangulation, or where a
  // policy of the library splits, may change there.
  [[nodiscard]] std::uint64_t hash() const noexcept;

 private:
  friend internal::MeshAccess;
  internal::MeshState* state_ = nullptr;
  KeepAlive keep_alive_{};
};

}  // namespace ETCM_IDS
}  // namespace etcm
