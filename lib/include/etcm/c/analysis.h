// What a mesh tells the operator of a network, for C: links, relays, holes, gaps, readings
// (etcm/analysis.h says what counts, and why). Exact; changes nothing, takes no memory.
//
// Links and connectivity take each vertex of the mesh they are given for a device. Ranges are whole
// units, at least 1. Lists as in etcm/c/mesh.h.
#pragma once

#include "etcm/c/questions.h"

#ifdef __cplusplus
extern "C" {
#endif

// A longer range changes nothing.
#define ETCM_RANGE_MAX 50331648u

typedef struct {
  etcm_vertex_t from;
  etcm_vertex_t to;
  bool constrained;  // part of a feature
  bool gabriel;      // no other vertex in or on the circle that has the edge as diameter
  bool urquhart;     // in neither of its triangles longer than both other edges
} etcm_link_t;

// A list: the edges longer than a range, each once; 0: all. O(n).
uint32_t etcm_links(const etcm_mesh_t* mesh, uint32_t longer_than, etcm_link_t* out, size_t room);
// A list: the links of one vertex, as etcm_neighbours() has them. O(degree).
uint32_t etcm_links_at(const etcm_mesh_t* mesh, etcm_vertex_t vertex, etcm_link_t* out,
                       size_t room);

typedef struct {
  // The longest edge of the minimum spanning tree: radios that reach this far make the network one.
  etcm_squared_length_t least;
  etcm_vertex_t from;  // that edge
  etcm_vertex_t to;
  uint32_t parts;  // the parts into which the network falls at `radio_range`
} etcm_connectivity_t;

typedef struct {
  etcm_vertex_t part;
  etcm_id_t edge;
} etcm_connectivity_scratch_t;

// For links between any two vertices. `scratch` needs etcm_vertex_id_end() entries, else
// ETCM_BUFFER_TOO_SMALL. O(n log n).
ETCM_MUST_USE etcm_status_t etcm_connectivity(const etcm_mesh_t* mesh, uint32_t radio_range,
                                              etcm_connectivity_scratch_t* scratch, size_t room,
                                              etcm_connectivity_t* out);

typedef struct {
  etcm_point_t position;
  etcm_feature_t feature;  // that it is on; ETCM_NONE: a node that is on none
  etcm_vertex_t vertex;    // that stands there without a device; ETCM_NONE: between vertices
} etcm_relay_t;

// A list: where relays have to stand so that no hop along a feature is longer than the range. The
// vertices of `devices` are the devices.
uint64_t etcm_relays(const etcm_mesh_t* mesh, const etcm_mesh_t* devices, uint32_t radio_range,
                     etcm_relay_t* out, size_t room);

typedef struct {
  etcm_feature_t feature;
  etcm_vertex_t from;  // ids of the mesh that has the features
  etcm_vertex_t to;
  bool watched;  // sensors beside the feature see every place between them all the same
} etcm_gap_t;

// A list: the parts of the features of `mesh` that the sensors on them do not see whole.
uint32_t etcm_barrier_gaps(const etcm_mesh_t* mesh, const etcm_mesh_t* sensors,
                           uint32_t sensing_range, etcm_gap_t* out, size_t room);

typedef struct {
  etcm_point_t position;  // rounded to the nearest sub-unit
  etcm_point_t sensor;    // the nearest (one of them)
  bool on_boundary;
} etcm_hole_t;

// A list: places of the domain farther than the range from every sensor, where one more would see
// most; empty exactly if there is none. The domain is what etcm_label_domain() has labelled inside
// in `region`, one for each triangle of `domain`; where that is null, the hull of the sensors.
uint32_t etcm_coverage_holes(const etcm_mesh_t* sensors, const etcm_mesh_t* domain,
                             const etcm_region_t* region, size_t region_count,
                             uint32_t sensing_range, etcm_hole_t* out, size_t room);

typedef struct {
  etcm_locate_type_t type;  // ETCM_LOCATE_OUTSIDE: there is no value
  int64_t value;            // in 2^-28 of the unit of the readings, rounded to the nearest
} etcm_interpolated_t;

// A reading at any place within the hull, linear in the triangle there. `readings` has one for each
// node, by vertex id, etcm_vertex_id_end() in all, else ETCM_BUFFER_TOO_SMALL. Costs one
// etcm_locate().
ETCM_MUST_USE etcm_status_t etcm_interpolate(const etcm_mesh_t* mesh, etcm_point_t place,
                                             const int32_t* readings, size_t reading_count,
                                             etcm_interpolated_t* out);

#ifdef __cplusplus
}
#endif
