// What is at a place, around it and at a node; which part of a mesh is the domain; proofs. For C.
#pragma once

#include "etcm/c/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

// --- Where a point lies (etcm/locate.h)

typedef uint8_t etcm_locate_type_t;
enum {
  ETCM_LOCATE_OUTSIDE = 0,
  ETCM_LOCATE_INSIDE_TRIANGLE = 1,
  ETCM_LOCATE_ON_EDGE = 2,
  ETCM_LOCATE_ON_VERTEX = 3
};

typedef struct {
  etcm_locate_type_t type;
  etcm_triangle_id_t triangle;  // of an edge or a vertex one of theirs; outside a ghost, or none
  int side;                     // ETCM_LOCATE_ON_EDGE: the edge opposite corner[side]
  etcm_vertex_t vertex;         // ETCM_LOCATE_ON_VERTEX
} etcm_location_t;

// Finds `point`, which may be any, by a walk from the triangle `near` (ETCM_NONE: from a node
// nearby, expected O(1) for nodes spread evenly).
void etcm_locate(const etcm_mesh_t* mesh, etcm_point_t point, etcm_triangle_id_t near,
                 etcm_location_t* location);

// --- Lengths (etcm/length.h)

// The square of a distance in squared sub-units, exact: high * 2^64 + low.
typedef struct {
  uint64_t high;
  uint64_t low;
} etcm_squared_length_t;

// Coordinates are at most 2^52 in magnitude.
etcm_squared_length_t etcm_squared_distance(etcm_point_t a, etcm_point_t b);
// The least whole number of units that is not shorter.
uint32_t etcm_range_for(etcm_squared_length_t length);

// --- Nearest nodes (etcm/nearest.h)

typedef struct {
  etcm_vertex_t node;
  etcm_squared_length_t distance;
} etcm_near_node_t;

// The nearest node, exactly; of several the lexicographically first. ETCM_NONE in an empty mesh.
// Coordinates of `place` are at most 2^52 in magnitude.
etcm_vertex_t etcm_nearest_node(const etcm_mesh_t* mesh, etcm_point_t place);
// Writes the nearest nodes, the nearest first, and returns how many it has written: fewer than
// `room` only where there are no more.
uint32_t etcm_nearest_nodes(const etcm_mesh_t* mesh, etcm_point_t place, etcm_near_node_t* out,
                            size_t room);
// A list: the nodes that are no farther than `range`, in units, the nearest first.
uint32_t etcm_nodes_within(const etcm_mesh_t* mesh, etcm_point_t place, uint32_t range,
                           etcm_near_node_t* out, size_t room);

// --- Features at a node (etcm/incidence.h)

typedef struct {
  etcm_feature_t feature;
  bool is_end;  // it ends at the vertex; else it runs through
} etcm_feature_at_t;

// A list: the features at a vertex, which must be in use, by increasing ids. O(d log d).
uint32_t etcm_features_at(const etcm_mesh_t* mesh, etcm_vertex_t vertex, etcm_feature_at_t* out,
                          size_t room);
// The feature that the edge between two vertices in use is part of; else ETCM_NONE.
etcm_feature_t etcm_feature_between(const etcm_mesh_t* mesh, etcm_vertex_t from, etcm_vertex_t to);

// --- The domain (etcm/domain.h)

typedef uint8_t etcm_region_t;
enum { ETCM_REGION_INSIDE = 0, ETCM_REGION_OUTSIDE = 1, ETCM_REGION_HOLE = 2 };
typedef uint8_t etcm_exterior_t;
enum {
  ETCM_EXTERIOR_HULL = 0,      // everything within the convex hull is domain
  ETCM_EXTERIOR_FEATURES = 1,  // closed features bound it
  ETCM_EXTERIOR_AUTOMATIC = 2  // features, where every node is on or within closed ones; else hull
};

// Labels each triangle: region[i] is that of triangle i; ghosts are outside. A hole is what can be
// reached from a seed without crossing a feature. `region` and `scratch` need etcm_triangle_count()
// entries, else ETCM_BUFFER_TOO_SMALL. O(n).
ETCM_MUST_USE etcm_status_t etcm_label_domain(const etcm_mesh_t* mesh, etcm_exterior_t exterior,
                                              const etcm_point_t* hole_seeds, size_t seed_count,
                                              etcm_region_t* region, size_t region_room,
                                              etcm_triangle_id_t* scratch, size_t scratch_room);

// --- Proofs (etcm/audit.h, etcm/bound.h)

typedef uint8_t etcm_rule_t;
enum {
  ETCM_RULE_NONE = 0,
  ETCM_RULE_COUNTS = 1,
  ETCM_RULE_LINKS = 2,
  ETCM_RULE_INCIDENCE = 3,
  ETCM_RULE_ORIENTATION = 4,
  ETCM_RULE_HULL = 5,
  ETCM_RULE_DELAUNAY = 6,
  ETCM_RULE_CANONICAL = 7,
  ETCM_RULE_ON_FEATURE = 8,
  ETCM_RULE_CONFORMING = 9
};

typedef struct {
  etcm_rule_t broken;  // the first broken rule; ETCM_RULE_NONE: the mesh is what it should be
  etcm_vertex_t vertex;
  etcm_triangle_id_t triangle;
  etcm_feature_t feature;
} etcm_audit_t;

// Whether the mesh is what is promised, checked exactly, and where it is not. What
// etcm_unresolved() counts breaks no rule: that it is not made is known. O(n * degree).
void etcm_audit(const etcm_mesh_t* mesh, etcm_audit_t* audit);
// The name of a rule, such as "delaunay". Never null.
const char* etcm_rule_name(etcm_rule_t rule);

// The fewest Steiner vertices with which a feature between two nodes can be a union of edges;
// `nodes` is a mesh without features.
uint32_t etcm_least_steiner(const etcm_mesh_t* nodes, etcm_vertex_t from, etcm_vertex_t to);

// --- Exact predicates (etcm/predicates.h): coordinates are at most 2^52 in magnitude

// +1 where a, b, c turn counter-clockwise, -1 clockwise, 0 on one line.
int etcm_orient2d(etcm_point_t a, etcm_point_t b, etcm_point_t c);
// For a counter-clockwise triangle +1 where d is inside its circle, -1 outside, 0 on it.
int etcm_incircle(etcm_point_t a, etcm_point_t b, etcm_point_t c, etcm_point_t d);
// The same with ties broken by the perturbation; never 0. Four distinct points, a, b, c
// counter-clockwise.
int etcm_incircle_perturbed(etcm_point_t a, etcm_point_t b, etcm_point_t c, etcm_point_t d);

#ifdef __cplusplus
}
#endif
