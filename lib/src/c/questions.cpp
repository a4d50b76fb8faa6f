#include "etcm/c/questions.h"

#include "c/same.h"
#include "etcm/audit.h"
#include "etcm/bound.h"
#include "etcm/domain.h"
#include "etcm/incidence.h"
#include "etcm/length.h"
#include "etcm/locate.h"
#include "etcm/nearest.h"
#include "etcm/predicates.h"

using namespace etcm;
using namespace etcm::c;

ETCM_SAME_MEMBER(Location, etcm_location_t, type, type);
ETCM_SAME_MEMBER(Location, etcm_location_t, triangle, triangle);
ETCM_SAME_MEMBER(Location, etcm_location_t, side, side);
ETCM_SAME_MEMBER(Location, etcm_location_t, vertex, vertex);
ETCM_SAME_MEMBER(SquaredLength, etcm_squared_length_t, high, high);
ETCM_SAME_MEMBER(SquaredLength, etcm_squared_length_t, low, low);
ETCM_SAME_MEMBER(NearNode, etcm_near_node_t, node, node);
ETCM_SAME_MEMBER(NearNode, etcm_near_node_t, distance, distance);
ETCM_SAME_MEMBER(FeatureAt, etcm_feature_at_t, feature, feature);
ETCM_SAME_MEMBER(FeatureAt, etcm_feature_at_t, is_end, is_end);
ETCM_SAME_MEMBER(Audit, etcm_audit_t, broken, broken);
ETCM_SAME_MEMBER(Audit, etcm_audit_t, vertex, vertex);
ETCM_SAME_MEMBER(Audit, etcm_audit_t, triangle, triangle);
ETCM_SAME_MEMBER(Audit, etcm_audit_t, feature, feature);

#define ETCM_SAME(number, value) static_assert((number) == static_cast<int>(value))
ETCM_SAME(ETCM_LOCATE_OUTSIDE, LocateType::outside);
ETCM_SAME(ETCM_LOCATE_INSIDE_TRIANGLE, LocateType::inside_triangle);
ETCM_SAME(ETCM_LOCATE_ON_EDGE, LocateType::on_edge);
ETCM_SAME(ETCM_LOCATE_ON_VERTEX, LocateType::on_vertex);
ETCM_SAME(ETCM_REGION_INSIDE, Region::inside);
ETCM_SAME(ETCM_REGION_OUTSIDE, Region::outside);
ETCM_SAME(ETCM_REGION_HOLE, Region::hole);
ETCM_SAME(ETCM_EXTERIOR_HULL, Exterior::hull);
ETCM_SAME(ETCM_EXTERIOR_FEATURES, Exterior::features);
ETCM_SAME(ETCM_EXTERIOR_AUTOMATIC, Exterior::automatic);
ETCM_SAME(ETCM_RULE_NONE, Rule::none);
ETCM_SAME(ETCM_RULE_COUNTS, Rule::counts);
ETCM_SAME(ETCM_RULE_LINKS, Rule::links);
ETCM_SAME(ETCM_RULE_INCIDENCE, Rule::incidence);
ETCM_SAME(ETCM_RULE_ORIENTATION, Rule::orientation);
ETCM_SAME(ETCM_RULE_HULL, Rule::hull);
ETCM_SAME(ETCM_RULE_DELAUNAY, Rule::delaunay);
ETCM_SAME(ETCM_RULE_CANONICAL, Rule::canonical);
ETCM_SAME(ETCM_RULE_ON_FEATURE, Rule::on_feature);
ETCM_SAME(ETCM_RULE_CONFORMING, Rule::conforming);

void etcm_locate(const etcm_mesh_t* mesh, etcm_point_t point, etcm_triangle_id_t near,
                 etcm_location_t* location) {
  *location = as<etcm_location_t>(locate(mesh_of(mesh), as<Point>(point), TriangleId{near}));
}

etcm_squared_length_t etcm_squared_distance(etcm_point_t a, etcm_point_t b) {
  return as<etcm_squared_length_t>(squared_distance(as<Point>(a), as<Point>(b)));
}

uint32_t etcm_range_for(etcm_squared_length_t length) {
  return range_for(as<SquaredLength>(length));
}

etcm_vertex_t etcm_nearest_node(const etcm_mesh_t* mesh, etcm_point_t place) {
  return number(nearest_node(mesh_of(mesh), as<Point>(place)));
}

uint32_t etcm_nearest_nodes(const etcm_mesh_t* mesh, etcm_point_t place, etcm_near_node_t* out,
                            size_t room) {
  return nearest_nodes(mesh_of(mesh), as<Point>(place), list<NearNode>(out, room));
}

uint32_t etcm_nodes_within(const etcm_mesh_t* mesh, etcm_point_t place, uint32_t range,
                           etcm_near_node_t* out, size_t room) {
  return nodes_within(mesh_of(mesh), as<Point>(place), range, list<NearNode>(out, room));
}

uint32_t etcm_features_at(const etcm_mesh_t* mesh, etcm_vertex_t vertex, etcm_feature_at_t* out,
                          size_t room) {
  return features_at(mesh_of(mesh), VertexId{vertex}, list<FeatureAt>(out, room));
}

etcm_feature_t etcm_feature_between(const etcm_mesh_t* mesh, etcm_vertex_t from, etcm_vertex_t to) {
  return number(feature_between(mesh_of(mesh), VertexId{from}, VertexId{to}));
}

etcm_status_t etcm_label_domain(const etcm_mesh_t* mesh, etcm_exterior_t exterior,
                                const etcm_point_t* hole_seeds, size_t seed_count,
                                etcm_region_t* region, size_t region_room,
                                etcm_triangle_id_t* scratch, size_t scratch_room) {
  return number(label_domain(
      mesh_of(mesh), static_cast<Exterior>(exterior), list<const Point>(hole_seeds, seed_count),
      list<Region>(region, region_room), list<TriangleId>(scratch, scratch_room)));
}

void etcm_audit(const etcm_mesh_t* mesh, etcm_audit_t* result) {
  *result = as<etcm_audit_t>(audit(mesh_of(mesh)));
}

const char* etcm_rule_name(etcm_rule_t rule) { return to_string(static_cast<Rule>(rule)); }

uint32_t etcm_least_steiner(const etcm_mesh_t* nodes, etcm_vertex_t from, etcm_vertex_t to) {
  return least_steiner(mesh_of(nodes), {VertexId{from}, VertexId{to}});
}

int etcm_orient2d(etcm_point_t a, etcm_point_t b, etcm_point_t c) {
  return orient2d(as<Point>(a), as<Point>(b), as<Point>(c));
}

int etcm_incircle(etcm_point_t a, etcm_point_t b, etcm_point_t c, etcm_point_t d) {
  return incircle(as<Point>(a), as<Point>(b), as<Point>(c), as<Point>(d));
}

int etcm_incircle_perturbed(etcm_point_t a, etcm_point_t b, etcm_point_t c, etcm_point_t d) {
  return incircle_perturbed(as<Point>(a), as<Point>(b), as<Point>(c), as<Point>(d));
}
