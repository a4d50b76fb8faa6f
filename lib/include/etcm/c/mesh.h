// The mesh for C: its memory, what changes it and what reads it.
//
// A call that changes the mesh succeeds whole, or the mesh is as it was, ids and etcm_hash()
// included, and the status says why. But etcm_build() may leave a partly conforming mesh, and says
// so; etcm_canonicalize() and etcm_optimise() keep what they have done, each step of it whole. A
// refused call rearranges the storage all the same: triangles may have other numbers,
// etcm_neighbours() may begin with another, and a seal wants to be made anew (bytes.h). Each
// takes a limit of work (ETCM_UNLIMITED: none), counted and so the same on every
// machine; docs/work.md has the time of a unit. One that would need more answers ETCM_WORK_LIMIT.
//
// Room-and-bounds statuses of a change: ETCM_OUT_OF_VERTICES, ETCM_OUT_OF_FEATURES,
// ETCM_STEINER_BUDGET, ETCM_WORK_LIMIT, ETCM_GRID_EXHAUSTED. What a change takes out keeps its
// place until the change ends, so a mesh that is nearly full may be too full for it. Besides, each
// answers ETCM_MESH_UNRESOLVED where etcm_build() has left features unresolved; etcm_save() does
// too, and etcm_build(), etcm_restore() and etcm_load() answer ETCM_MESH_NOT_EMPTY. The way on is
// etcm_open() with a greater vertices_max or steiner_max (how much is not known: twice as much),
// and etcm_build(); or etcm_clear(), which gives no more room, and etcm_build() of fewer features,
// after ETCM_GRID_EXHAUSTED without the one that etcm_error_detail() names or with nodes farther
// apart.
//
// Ids: a node that joins gets the least id above 0 that no vertex has, a feature the least that no
// feature and no further segment of one has; a Steiner vertex takes the least, too, when it comes.
// So the same calls on the same mesh give the same ids, whatever the history and the machine, as
// long as they get the same answers: a limit may be enough in one of two meshes that came about in
// other ways, as a loaded one has, and not in the other (docs/work.md). But etcm_canonicalize(),
// etcm_rebuild() and etcm_optimise(): what they lay again goes with the changes that were made
// before, those aside that were refused and dry runs. So after them two meshes that came about in
// other ways are compared by etcm_hash(), and ids by where they stand. The same nodes in another
// order have other ids. In which order Steiner vertices come, and so their ids and those of nodes
// that join after them, may be another in the next version of the library; they have other ids
// after etcm_canonicalize() than after etcm_build(). What the mesh is like, but for the ids,
// depends on its vertices and features alone; which Steiner vertices there are depends on the
// history, until etcm_canonicalize() makes the mesh what etcm_build() makes.
//
// Lists: a call writes as many entries as fit and returns how many there are; the buffer may be
// null where `room` is 0.
#pragma once

#include "etcm/c/types.h"

#ifdef __cplusplus
extern "C" {
#endif

// --- Memory

// Capacities that are enough, as a rule, for so many nodes that stand about evenly and
// so many features of any length between them, for changes as well (etcm/config.h): constants where
// the numbers are. Short features need less; where nodes crowd along features it may take more, and
// then a call answers ETCM_OUT_OF_VERTICES or ETCM_OUT_OF_FEATURES.
#define ETCM_VERTICES_FOR(nodes, features) \
  ((uint32_t)(nodes) + 2u * ETCM_BINARY_DIGITS(nodes) * (uint32_t)(features))
#define ETCM_SEGMENTS_FOR(features) (2u * (uint32_t)(features))
// How many digits the number of nodes has.
#define ETCM_BINARY_DIGITS(number)         \
  ((uint32_t)(number) < 1u           ? 0u  \
   : (uint32_t)(number) < 2u         ? 1u  \
   : (uint32_t)(number) < 4u         ? 2u  \
   : (uint32_t)(number) < 8u         ? 3u  \
   : (uint32_t)(number) < 16u        ? 4u  \
   : (uint32_t)(number) < 32u        ? 5u  \
   : (uint32_t)(number) < 64u        ? 6u  \
   : (uint32_t)(number) < 128u       ? 7u  \
   : (uint32_t)(number) < 256u       ? 8u  \
   : (uint32_t)(number) < 512u       ? 9u  \
   : (uint32_t)(number) < 1024u      ? 10u \
   : (uint32_t)(number) < 2048u      ? 11u \
   : (uint32_t)(number) < 4096u      ? 12u \
   : (uint32_t)(number) < 8192u      ? 13u \
   : (uint32_t)(number) < 16384u     ? 14u \
   : (uint32_t)(number) < 32768u     ? 15u \
   : (uint32_t)(number) < 65536u     ? 16u \
   : (uint32_t)(number) < 131072u    ? 17u \
   : (uint32_t)(number) < 262144u    ? 18u \
   : (uint32_t)(number) < 524288u    ? 19u \
   : (uint32_t)(number) < 1048576u   ? 20u \
   : (uint32_t)(number) < 2097152u   ? 21u \
   : (uint32_t)(number) < 4194304u   ? 22u \
   : (uint32_t)(number) < 8388608u   ? 23u \
   : (uint32_t)(number) < 16777216u  ? 24u \
   : (uint32_t)(number) < 33554432u  ? 25u \
   : (uint32_t)(number) < 67108864u  ? 26u \
   : (uint32_t)(number) < 134217728u ? 27u \
   : (uint32_t)(number) < 268435456u ? 28u \
                                     : 29u)

// As many cells as the grid of hints has: one for 4 vertices at the most.
#define ETCM_HINT_CELLS(vertices)                  \
  ((uint64_t)(vertices) < 16u          ? 1u        \
   : (uint64_t)(vertices) < 64u        ? 4u        \
   : (uint64_t)(vertices) < 256u       ? 16u       \
   : (uint64_t)(vertices) < 1024u      ? 64u       \
   : (uint64_t)(vertices) < 4096u      ? 256u      \
   : (uint64_t)(vertices) < 16384u     ? 1024u     \
   : (uint64_t)(vertices) < 65536u     ? 4096u     \
   : (uint64_t)(vertices) < 262144u    ? 16384u    \
   : (uint64_t)(vertices) < 1048576u   ? 65536u    \
   : (uint64_t)(vertices) < 4194304u   ? 262144u   \
   : (uint64_t)(vertices) < 16777216u  ? 1048576u  \
   : (uint64_t)(vertices) < 67108864u  ? 4194304u  \
   : (uint64_t)(vertices) < 268435456u ? 16777216u \
                                       : 67108864u)

// Bytes of a mesh of these capacities, all in: a constant where they are. Capacities are at most
// ETCM_VERTICES_LIMIT and ETCM_FEATURES_LIMIT; for what a size_t cannot tell, the greatest there
// is.
#define ETCM_STORAGE_BYTES(vertices, features)             \
  (ETCM_STORAGE_BYTES_64(vertices, features) < SIZE_MAX    \
       ? (size_t)ETCM_STORAGE_BYTES_64(vertices, features) \
       : SIZE_MAX)
#define ETCM_STORAGE_BYTES_64(vertices, features)                            \
  (768u + (16u + 14u * (uint64_t)sizeof(etcm_id_t)) * (uint64_t)(vertices) + \
   12u * (uint64_t)sizeof(etcm_id_t) * (uint64_t)(features) +                \
   (uint64_t)sizeof(etcm_id_t) * ETCM_HINT_CELLS(vertices))

// The most bytes that etcm_save() writes of a mesh of these capacities: a constant where they are.
// For what a size_t cannot tell, the greatest there is.
#define ETCM_SAVED_BYTES(vertices, features)             \
  (ETCM_SAVED_BYTES_64(vertices, features) < SIZE_MAX    \
       ? (size_t)ETCM_SAVED_BYTES_64(vertices, features) \
       : SIZE_MAX)
#define ETCM_SAVED_BYTES_64(vertices, features) \
  (48u + 8u * (uint64_t)(vertices) + 16u * (uint64_t)(features))

// Declares an array that etcm_open() takes: static ETCM_STORAGE(storage, vertices, segments);
#define ETCM_STORAGE(name, vertices, features) \
  unsigned char name[ETCM_STORAGE_BYTES(vertices, features)] __attribute__((aligned(8)))

struct etcm_split_policy;

// What is decided once. What is 0 may be left out.
typedef struct {
  // Nodes and Steiner vertices together, 1 to ETCM_VERTICES_LIMIT.
  uint32_t vertices_max;
  // One place for each segment of a feature between neighbouring nodes on it, at most
  // ETCM_FEATURES_LIMIT; 0: a plain Delaunay mesh.
  uint32_t features_max;
  // Most Steiner vertices there may be; 0: as many as vertices_max leaves room for.
  uint32_t steiner_max;
  // Null: the rule that needs the fewest. Else one of one's own (c/policy.h), which must outlive
  // the mesh.
  const struct etcm_split_policy* policy;
} etcm_config_t;

// A mesh. All zero (static, or {0}) it is not open; so it must be before the first call that takes
// it, at each start anew: it does not lie where start-up code clears nothing. What it points to is
// in the storage. It must stay where it is while it is open, and is not copied.
typedef struct {
  void* state;
  void (*keep_alive)(void* context);
  void* keep_alive_context;
} etcm_mesh_t;

// Sets the capacities to ETCM_VERTICES_FOR() and ETCM_SEGMENTS_FOR(), within the limits, and the
// rest to 0.
void etcm_capacity_for(uint32_t nodes, uint32_t features, etcm_config_t* config);

// Whether etcm_open() would take the configuration: ETCM_OK or ETCM_BAD_CONFIG, also where its
// policy has no function, or it needs more memory than a size_t can tell.
ETCM_MUST_USE etcm_status_t etcm_validate(const etcm_config_t* config);

// ETCM_STORAGE_BYTES() for capacities that are known when the program runs.
size_t etcm_storage_bytes(uint32_t vertices_max, uint32_t features_max);
// Likewise ETCM_SAVED_BYTES().
size_t etcm_saved_bytes_most(uint32_t vertices_max, uint32_t features_max);

// The first call that any mesh needs has the width of ids in its name (types.h).
#if ETCM_ID_BITS == 16
#define etcm_open etcm_open_ids_16
#else
#define etcm_open etcm_open_ids_32
#endif
// Takes the storage, which must outlive the mesh, be aligned to 8 and have at least
// etcm_storage_bytes(); it need not be zeroed, and whatever was in it, the mesh is empty. Of two
// meshes on one storage only the one that was opened or attached last may be used. Keeps the
// function of etcm_keep_alive(), which may be given before. Errors: ETCM_BAD_CONFIG,
// ETCM_STORAGE_TOO_SMALL; then the mesh is what it was before. O(1).
ETCM_MUST_USE etcm_status_t etcm_open(etcm_mesh_t* mesh, void* storage, size_t bytes,
                                      const etcm_config_t* config);

// Forgets all nodes and features. O(1).
void etcm_clear(etcm_mesh_t* mesh);

// --- Changes

// For calls that may take as long as they need.
#define ETCM_UNLIMITED UINT64_MAX

typedef struct {
  etcm_vertex_t from;
  etcm_vertex_t to;
} etcm_feature_ends_t;

// A Steiner vertex that stood on a feature: its index in the list given beside it, and its place.
typedef struct {
  uint32_t feature;
  etcm_point_t point;
} etcm_steiner_place_t;

// What the last change stumbled over: its status, ETCM_OK where it succeeded; what does not apply
// is ETCM_NONE, or 0. What only reads, and a dry run, leaves it.
typedef struct {
  etcm_status_t status;
  etcm_vertex_t vertex;    // the node in the way, or the unknown one
  etcm_vertex_t rejected;  // ETCM_DUPLICATE_VERTEX of etcm_build(): who stands there too
  etcm_feature_t feature;  // that cannot be made (of etcm_build(): its index in the input; of
                           //   etcm_add_feature() ETCM_NONE where it is the new one), or that
                           //   etcm_canonicalize() has got to
  etcm_feature_t other;    // that it crosses, overlaps or repeats (as above)
  etcm_point_t from;       // the unresolved subsegment of that one, for ETCM_STEINER_BUDGET
  etcm_point_t to;         //   and ETCM_GRID_EXHAUSTED
} etcm_error_detail_t;

// Builds an empty mesh from nodes and features at once: node i becomes vertex i + 1, which features
// are given by, feature i has the id i. Errors in the input, and ETCM_WORK_LIMIT, leave the mesh
// empty; etcm_error_detail() names the culprit. ETCM_STEINER_BUDGET, ETCM_GRID_EXHAUSTED and
// ETCM_OUT_OF_VERTICES leave what is done: etcm_unresolved() counts the rest, and changes are
// refused until etcm_clear(). Errors besides: ETCM_MESH_NOT_EMPTY; in the input
// ETCM_BAD_COORDINATE, ETCM_DUPLICATE_VERTEX, those of etcm_add_feature(), and ETCM_OUT_OF_VERTICES
// for more nodes than vertices_max. O(n log n).
ETCM_MUST_USE etcm_status_t etcm_build(etcm_mesh_t* mesh, const etcm_position_t* nodes,
                                       size_t node_count, const etcm_feature_ends_t* features,
                                       size_t feature_count, uint64_t limit);
// The same, and calls nodes_stand(context) between the nodes and the first feature: for who
// measures both. It must not use the mesh.
ETCM_MUST_USE etcm_status_t etcm_build_measured(etcm_mesh_t* mesh, const etcm_position_t* nodes,
                                                size_t node_count,
                                                const etcm_feature_ends_t* features,
                                                size_t feature_count, uint64_t limit,
                                                void (*nodes_stand)(void* context), void* context);

// Makes an empty mesh what another one was, etcm_hash() included: its nodes and features as for
// etcm_build(), and its Steiner vertices. Splits nothing; whatever is wrong leaves the mesh empty.
// Errors: ETCM_MESH_NOT_EMPTY, and those of etcm_build() for its input; ETCM_BAD_COORDINATE or
// ETCM_DUPLICATE_VERTEX where a Steiner vertex stands at no place for one on its feature,
// ETCM_UNKNOWN_FEATURE where that is none of them, ETCM_MESH_UNRESOLVED where a feature would not
// be a union of edges, ETCM_STEINER_BUDGET and ETCM_OUT_OF_VERTICES where they are too many;
// ETCM_WORK_LIMIT. O(n log n).
ETCM_MUST_USE etcm_status_t etcm_restore(etcm_mesh_t* mesh, const etcm_position_t* nodes,
                                         size_t node_count, const etcm_feature_ends_t* features,
                                         size_t feature_count, const etcm_steiner_place_t* steiner,
                                         size_t steiner_count, uint64_t limit);

// Makes the mesh, whatever its history, the one that etcm_build() makes of the same nodes and
// features, bit for bit. Costs what the changes since can have had an influence on. With
// ETCM_WORK_LIMIT what is done stays, and the next call goes on where the limit is enough for one
// group of features: etcm_error_detail() names a feature of the first for which it was not. Where
// two calls in a row name the same, the limit is too little for that group but for rare cases, in
// which some calls more end: give a larger one. With long features one group is often all of them.
// ETCM_NONE is named before it is known where the groups begin, which takes sixteen calls or so:
// seventeen times in a row it asks for the same. Errors: the room-and-bounds statuses.
ETCM_MUST_USE etcm_status_t etcm_canonicalize(etcm_mesh_t* mesh, uint64_t limit);
// Whether it is known to be that mesh.
bool etcm_is_canonical(const etcm_mesh_t* mesh);
// The same from the ground up, all or nothing. Errors: the room-and-bounds statuses; it needs room
// for the old and the new Steiner vertices at once. O(n log n).
ETCM_MUST_USE etcm_status_t etcm_rebuild(etcm_mesh_t* mesh, uint64_t limit);
// Looks for fewer Steiner vertices, so many trials; never worse. Later calls go on from
// `first_trial`. etcm_canonicalize() takes it back. Errors: ETCM_WORK_LIMIT, and what is found
// stays.
ETCM_MUST_USE etcm_status_t etcm_optimise(etcm_mesh_t* mesh, uint32_t trials, uint32_t first_trial,
                                          uint64_t limit);

// A node joins, anywhere: on a Steiner vertex, on a feature (which then runs through it), outside.
// Sets `node` on success only. Errors: ETCM_BAD_COORDINATE, ETCM_DUPLICATE_VERTEX, room and bounds.
// Expected O(1) for nodes spread evenly.
ETCM_MUST_USE etcm_status_t etcm_join(etcm_mesh_t* mesh, etcm_position_t position, uint64_t limit,
                                      etcm_vertex_t* node);
// A node leaves. Errors: ETCM_UNKNOWN_VERTEX, ETCM_ENDPOINT_IN_USE, ETCM_CROSSING_FEATURES (two
// features met there), room and bounds but ETCM_OUT_OF_FEATURES.
ETCM_MUST_USE etcm_status_t etcm_leave(etcm_mesh_t* mesh, etcm_vertex_t node, uint64_t limit);
// A node moves, keeps its id, and the features that end at it follow it; one that runs through it
// stays, and runs through it no longer. Errors: ETCM_UNKNOWN_VERTEX, ETCM_BAD_COORDINATE,
// ETCM_DUPLICATE_VERTEX, ETCM_OVERLAPPING_FEATURES, ETCM_CROSSING_FEATURES, room and bounds.
ETCM_MUST_USE etcm_status_t etcm_move(etcm_mesh_t* mesh, etcm_vertex_t node,
                                      etcm_position_t position, uint64_t limit);
// Adds a feature between two nodes. Sets `feature` on success only. Features may share a node, at
// their ends or on the way: who wants one to end on another (a T-junction), or two to cross, lets a
// node join there first, exactly on the line; where lines cross between units, at a rounded place,
// and each is two features that end there. Errors: ETCM_UNKNOWN_VERTEX,
// ETCM_ZERO_LENGTH_FEATURE, ETCM_REPEATED_FEATURE, ETCM_OVERLAPPING_FEATURES,
// ETCM_CROSSING_FEATURES, room and bounds.
ETCM_MUST_USE etcm_status_t etcm_add_feature(etcm_mesh_t* mesh, etcm_vertex_t from,
                                             etcm_vertex_t to, uint64_t limit,
                                             etcm_feature_t* feature);
// Removes a feature and its Steiner vertices. Errors: ETCM_UNKNOWN_FEATURE, ETCM_WORK_LIMIT.
ETCM_MUST_USE etcm_status_t etcm_remove_feature(etcm_mesh_t* mesh, etcm_feature_t feature,
                                                uint64_t limit);

// Gives the function that each of these calls, a dry run and what reads much (such as etcm_audit(),
// etcm_hash(), etcm_save(), etcm_seal(), etcm_nodes_within() and the analysis) calls while it goes
// on, at most ETCM_KEEP_ALIVE_UNITS of work and one walk apart, so that a watchdog does not bite;
// null for none. A walk is tens of units as a rule, and never more than twice as many as there are
// triangles; of one across the mesh or along a line a change has 64 steps between two calls. The
// sort of a list that etcm_nodes_within() writes comes on top. Short questions call nothing
// (etcm/work.h names them). The mesh may be in the middle of a change then: `call` must not use it,
// nor its storage. It may kick a watchdog, read a clock, let other tasks run, use another mesh, but
// not what the call was given; to open or attach a mesh on that storage is a mistake that nobody
// notices. It cannot end the call. Where several threads read one mesh, each calls it, and a
// question in an interrupt calls it there; where `call` asks a mesh that has the same hook, it is
// called by itself. It is kept by etcm_open() and etcm_attach(), until another is given;
// docs/work.md has what it is good for.
#define ETCM_KEEP_ALIVE_UNITS 256u
void etcm_keep_alive(etcm_mesh_t* mesh, void (*call)(void* context), void* context);

// What the last of these calls has done.
uint64_t etcm_work_used(const etcm_mesh_t* mesh);
// The least limit with which it succeeds, where it has. Where it was refused only what it had done,
// which is no limit to try: after ETCM_WORK_LIMIT the way on is a greater limit, or ETCM_UNLIMITED
// with etcm_keep_alive(). With the same it is refused again, as a rule; etcm_canonicalize() goes
// on.
uint64_t etcm_work_needed(const etcm_mesh_t* mesh);

// Of the last change, refused or not; after etcm_open() and etcm_clear() of none. O(1).
void etcm_error_detail(const etcm_mesh_t* mesh, etcm_error_detail_t* detail);

// --- Reading

// What etcm_open() was given; the policy only where it was not one of the library's.
void etcm_config(const etcm_mesh_t* mesh, etcm_config_t* config);

// Counts. O(1), but etcm_finite_triangle_count(): O(hull).
uint32_t etcm_node_count(const etcm_mesh_t* mesh);
uint32_t etcm_steiner_count(const etcm_mesh_t* mesh);
uint32_t etcm_feature_count(const etcm_mesh_t* mesh);
uint32_t etcm_triangle_count(const etcm_mesh_t* mesh);  // ghosts included
uint32_t etcm_finite_triangle_count(const etcm_mesh_t* mesh);
uint32_t etcm_unresolved(const etcm_mesh_t* mesh);  // subsegments that are no edges
// Every id in use is below this; ids between may be free.
uint32_t etcm_vertex_id_end(const etcm_mesh_t* mesh);
uint32_t etcm_feature_id_end(const etcm_mesh_t* mesh);

// Of a vertex: what stands there. The id must be below etcm_vertex_id_end(), and in use for all but
// etcm_kind(), else the call is illegal.
typedef uint8_t etcm_kind_t;
enum { ETCM_KIND_NONE = 0, ETCM_KIND_NODE = 1, ETCM_KIND_STEINER = 2 };

typedef struct {
  etcm_vertex_t vertex;
  bool constrained;  // the edge is part of a feature
} etcm_neighbour_t;

etcm_kind_t etcm_kind(const etcm_mesh_t* mesh, etcm_vertex_t vertex);
etcm_point_t etcm_point(const etcm_mesh_t* mesh, etcm_vertex_t vertex);
// Where a node stands, in units. A Steiner vertex stands between units as a rule, and what is
// behind the point is cut off: of one ask etcm_point().
etcm_position_t etcm_position(const etcm_mesh_t* mesh, etcm_vertex_t node);
// The feature that a Steiner vertex stands on. Of a node it answers any value, which means nothing
// and is no error: see etcm_features_at(). Where it stands there: etcm_point() is the place,
// exactly on the line; etcm_chain() has the order; the share of the way is (point - from) / (to -
// from) for the ends in sub-units, of x or of y, whichever differs more.
etcm_feature_t etcm_feature_of(const etcm_mesh_t* mesh, etcm_vertex_t steiner);
// A list: the neighbours counter-clockwise, without the vertex at infinity. There are less than 6
// on average, and of one vertex as many as there are others at the most: a list for
// vertices_max - 1 is never too short. O(degree).
uint32_t etcm_neighbours(const etcm_mesh_t* mesh, etcm_vertex_t vertex, etcm_neighbour_t* out,
                         size_t room);

// Triangles. The id must be below etcm_triangle_count().
typedef struct {
  etcm_vertex_t corner[3];          // counter-clockwise; a ghost has ETCM_INFINITE among them
  etcm_triangle_id_t neighbour[3];  // [i] is across the edge opposite corner[i]
  bool constrained[3];              // [i]: that edge is part of a feature
} etcm_triangle_t;
void etcm_triangle(const etcm_mesh_t* mesh, etcm_triangle_id_t id, etcm_triangle_t* triangle);

// Features. The id must be in use for all but etcm_is_feature().
bool etcm_is_feature(const etcm_mesh_t* mesh, etcm_feature_t feature);
etcm_feature_ends_t etcm_ends(const etcm_mesh_t* mesh, etcm_feature_t feature);
// A list: the vertices along the feature, both ends included. O(their degrees).
uint32_t etcm_chain(const etcm_mesh_t* mesh, etcm_feature_t feature, etcm_vertex_t* out,
                    size_t room);

// A number of the triangulation alone: the same for the same vertices, edges and subsegments,
// whatever the ids, the history and the machine. Between versions of the library compare it only
// where the part on formats of CHANGELOG.md is silent: the number of a triangulation, or where a
// policy of the library splits, may change there. O(n).
uint64_t etcm_hash(const etcm_mesh_t* mesh);

// --- All of them

// An edge; from < to.
typedef struct {
  etcm_vertex_t from;
  etcm_vertex_t to;
  bool constrained;  // part of a feature
} etcm_edge_t;

// Call visit(context, ...) for each, by increasing ids, edges by their triangles, until it answers
// false; answer whether it never did. `visit` must not change the mesh. O(n).
bool etcm_nodes_of(const etcm_mesh_t* mesh, bool (*visit)(void* context, etcm_vertex_t node),
                   void* context);
bool etcm_features_of(const etcm_mesh_t* mesh, bool (*visit)(void* context, etcm_feature_t feature),
                      void* context);
bool etcm_edges_of(const etcm_mesh_t* mesh, bool (*visit)(void* context, const etcm_edge_t* edge),
                   void* context);

#ifdef __cplusplus
}
#endif
