// Where to split a segment of a feature that is not yet an edge, for C programs that want another
// rule than the library's.
#pragma once

#include "etcm/c/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

// A place on the grid of a segment between two nodes: 0 at one, ETCM_PARAMETER_END at the other.
typedef int32_t etcm_parameter_t;
#define ETCM_PARAMETER_END ((etcm_parameter_t)268435456)

// A missing subsegment of a feature, and its surroundings.
typedef struct {
  // Parameter t stands at from * 2^28 + t * (to - from).
  etcm_position_t from;
  etcm_position_t to;
  etcm_parameter_t head;
  etcm_parameter_t tail;
  // A split in (head, feasible_head] finishes head's part, one in [feasible_tail, tail) tail's.
  etcm_parameter_t feasible_head;
  etcm_parameter_t feasible_tail;
  // The ends of the edge that is crossed first, from head and from tail; right and left of the
  // direction from `from` to `to`.
  etcm_point_t head_right, head_left;
  etcm_point_t tail_right, tail_left;
  bool head_is_node;
  bool tail_is_node;
  bool is_lone;  // nothing of another feature is near
  const etcm_mesh_t* mesh;
  etcm_triangle_id_t head_triangle;
  etcm_triangle_id_t tail_triangle;
  void* library;  // not for the policy
} etcm_split_site_t;

// A rule, and what it is given with each site.
//
// `choose` returns a parameter in (head, tail): another is a programming error
// (ETCM_FAULT_OUTSIDE). It should be in (head, feasible_head] or in [feasible_tail, tail): a rule
// whose splits finish nothing uses up vertices, budget or work.
//
// Same site, same answer: a rule has no memory, and what `context` points to stays as it is while
// the mesh is open. It may read the vertices and triangles of site->mesh, a triangulation that
// stands: etcm_kind(), etcm_point(), etcm_neighbours(), etcm_triangle(), etcm_locate(),
// etcm_nearest_node(). Not all features are in it yet, so etcm_chain(), etcm_hash(),
// etcm_features_at() and etcm_audit() say nothing that holds. To change the mesh is a programming
// error. It may kick a watchdog. What time it takes is in no limit, and in between two calls of the
// function that etcm_keep_alive() was given.
typedef struct etcm_split_policy {
  etcm_parameter_t (*choose)(const etcm_split_site_t* site, void* context);
  void* context;
} etcm_split_policy_t;

// The library's rules, for one's own to ask; `context` is not looked at. The first is what
// etcm_config_t takes where it is given none; the second is that of the paper.
etcm_parameter_t etcm_split_default(const etcm_split_site_t* site, void* context);
etcm_parameter_t etcm_split_paper(const etcm_split_site_t* site, void* context);

// The point of a parameter.
etcm_point_t etcm_split_site_at(const etcm_split_site_t* site, etcm_parameter_t t);

// The triangles that the subsegment crosses, and what a vertex on it would break. For the time that
// `choose` runs; `site` must stay. What is a double is near enough for a choice, and the same on
// every machine.
typedef struct {
  uint64_t opaque[24];
} etcm_surroundings_t;

typedef uint8_t etcm_end_t;
enum { ETCM_END_HEAD = 0, ETCM_END_TAIL = 1 };

typedef struct {
  etcm_vertex_t vertex;
  bool is_node;
  etcm_point_t point;
  double along;  // where it stands along the subsegment, in parameters from site->head
  double aside;  // how far from its line, in the same unit
} etcm_beside_t;

void etcm_surroundings_open(etcm_surroundings_t* surroundings, const etcm_split_site_t* site);
// One over the squared length of the segment in units.
double etcm_surroundings_per_squared_length(const etcm_surroundings_t* surroundings);
// Goes along the triangles from one end on, head first, each end once; etcm_surroundings_next()
// answers false where there is no more.
void etcm_surroundings_start(etcm_surroundings_t* surroundings, etcm_end_t end);
bool etcm_surroundings_next(etcm_surroundings_t* surroundings, etcm_beside_t* beside);
// The node at that end of the segment where other segments end too; else ETCM_NONE.
etcm_vertex_t etcm_surroundings_shared_node(const etcm_surroundings_t* surroundings,
                                            etcm_end_t end);
// Whether the vertex stands on a segment that ends at the node.
bool etcm_surroundings_is_on_segment_from(const etcm_surroundings_t* surroundings,
                                          etcm_vertex_t node, etcm_vertex_t vertex);
// How many subsegments a vertex at t would break, `enough` at the most; and of those alone that the
// calls above have come by.
unsigned etcm_surroundings_encroachments(etcm_surroundings_t* surroundings, etcm_parameter_t t,
                                         unsigned enough);
unsigned etcm_surroundings_encroachments_at_least(const etcm_surroundings_t* surroundings,
                                                  etcm_parameter_t t);

// a * b, which no compiler fuses with a sum, and a square root, correctly rounded (etcm/policy.h):
// the same bits on every machine.
double etcm_product(double a, double b);
double etcm_root(double square);

#ifdef __cplusplus
}
#endif
