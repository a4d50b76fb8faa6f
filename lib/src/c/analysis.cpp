#include "etcm/c/analysis.h"

#include "c/same.h"
#include "etcm/analysis.h"

using namespace etcm;
using namespace etcm::c;

static_assert(ETCM_RANGE_MAX == range_max);
ETCM_SAME_MEMBER(Link, etcm_link_t, from, from);
ETCM_SAME_MEMBER(Link, etcm_link_t, to, to);
ETCM_SAME_MEMBER(Link, etcm_link_t, constrained, constrained);
ETCM_SAME_MEMBER(Link, etcm_link_t, gabriel, gabriel);
ETCM_SAME_MEMBER(Link, etcm_link_t, urquhart, urquhart);
ETCM_SAME_MEMBER(Connectivity, etcm_connectivity_t, least, least);
ETCM_SAME_MEMBER(Connectivity, etcm_connectivity_t, from, from);
ETCM_SAME_MEMBER(Connectivity, etcm_connectivity_t, to, to);
ETCM_SAME_MEMBER(Connectivity, etcm_connectivity_t, parts, parts);
ETCM_SAME_MEMBER(ConnectivityScratch, etcm_connectivity_scratch_t, part, part);
ETCM_SAME_MEMBER(ConnectivityScratch, etcm_connectivity_scratch_t, edge, edge);
ETCM_SAME_MEMBER(Relay, etcm_relay_t, position, position);
ETCM_SAME_MEMBER(Relay, etcm_relay_t, feature, feature);
ETCM_SAME_MEMBER(Relay, etcm_relay_t, vertex, vertex);
ETCM_SAME_MEMBER(Gap, etcm_gap_t, feature, feature);
ETCM_SAME_MEMBER(Gap, etcm_gap_t, from, from);
ETCM_SAME_MEMBER(Gap, etcm_gap_t, to, to);
ETCM_SAME_MEMBER(Gap, etcm_gap_t, watched, watched);
ETCM_SAME_MEMBER(Hole, etcm_hole_t, position, position);
ETCM_SAME_MEMBER(Hole, etcm_hole_t, sensor, sensor);
ETCM_SAME_MEMBER(Hole, etcm_hole_t, on_boundary, on_boundary);
ETCM_SAME_MEMBER(Interpolated, etcm_interpolated_t, type, type);
ETCM_SAME_MEMBER(Interpolated, etcm_interpolated_t, value, value);

uint32_t etcm_links(const etcm_mesh_t* mesh, uint32_t longer_than, etcm_link_t* out, size_t room) {
  return links(mesh_of(mesh), longer_than, list<Link>(out, room));
}

uint32_t etcm_links_at(const etcm_mesh_t* mesh, etcm_vertex_t vertex, etcm_link_t* out,
                       size_t room) {
  return links_at(mesh_of(mesh), VertexId{vertex}, list<Link>(out, room));
}

etcm_status_t etcm_connectivity(const etcm_mesh_t* mesh, uint32_t radio_range,
                                etcm_connectivity_scratch_t* scratch, size_t room,
                                etcm_connectivity_t* out) {
  Connectivity found;
  const Status status =
      connectivity(mesh_of(mesh), radio_range, list<ConnectivityScratch>(scratch, room), found);
  if (status == Status::ok) *out = as<etcm_connectivity_t>(found);
  return number(status);
}

uint64_t etcm_relays(const etcm_mesh_t* mesh, const etcm_mesh_t* devices, uint32_t radio_range,
                     etcm_relay_t* out, size_t room) {
  return relays(mesh_of(mesh), mesh_of(devices), radio_range, list<Relay>(out, room));
}

uint32_t etcm_barrier_gaps(const etcm_mesh_t* mesh, const etcm_mesh_t* sensors,
                           uint32_t sensing_range, etcm_gap_t* out, size_t room) {
  return barrier_gaps(mesh_of(mesh), mesh_of(sensors), sensing_range, list<Gap>(out, room));
}

uint32_t etcm_coverage_holes(const etcm_mesh_t* sensors, const etcm_mesh_t* domain,
                             const etcm_region_t* region, size_t region_count,
                             uint32_t sensing_range, etcm_hole_t* out, size_t room) {
  Domain asked;
  if (domain != nullptr) asked = {&mesh_of(domain), list<const Region>(region, region_count)};
  return coverage_holes(mesh_of(sensors), asked, sensing_range, list<Hole>(out, room));
}

etcm_status_t etcm_interpolate(const etcm_mesh_t* mesh, etcm_point_t place, const int32_t* readings,
                               size_t reading_count, etcm_interpolated_t* out) {
  Interpolated found;
  const Status status =
      interpolate(mesh_of(mesh), as<Point>(place), {readings, reading_count}, found);
  if (status == Status::ok) *out = as<etcm_interpolated_t>(found);
  return number(status);
}
