// What can be read of a mesh, for C.
#include "c/same.h"
#include "etcm/c/mesh.h"
#include "etcm/mesh.h"
#include "etcm/traverse.h"

using namespace etcm;
using namespace etcm::c;

ETCM_SAME_MEMBER(ErrorDetail, etcm_error_detail_t, status, status);
ETCM_SAME_MEMBER(ErrorDetail, etcm_error_detail_t, vertex, vertex);
ETCM_SAME_MEMBER(ErrorDetail, etcm_error_detail_t, rejected, rejected);
ETCM_SAME_MEMBER(ErrorDetail, etcm_error_detail_t, feature, feature);
ETCM_SAME_MEMBER(ErrorDetail, etcm_error_detail_t, other, other);
ETCM_SAME_MEMBER(ErrorDetail, etcm_error_detail_t, from, from);
ETCM_SAME_MEMBER(ErrorDetail, etcm_error_detail_t, to, to);
ETCM_SAME_MEMBER(Neighbour, etcm_neighbour_t, vertex, vertex);
ETCM_SAME_MEMBER(Neighbour, etcm_neighbour_t, constrained, constrained);
ETCM_SAME_MEMBER(Triangle, etcm_triangle_t, corner, corner);
ETCM_SAME_MEMBER(Triangle, etcm_triangle_t, neighbour, neighbour);
ETCM_SAME_MEMBER(Triangle, etcm_triangle_t, constrained, constrained);
ETCM_SAME_MEMBER(MeshEdge, etcm_edge_t, from, from);
ETCM_SAME_MEMBER(MeshEdge, etcm_edge_t, to, to);
ETCM_SAME_MEMBER(MeshEdge, etcm_edge_t, constrained, constrained);
static_assert(ETCM_KIND_NONE == static_cast<int>(VertexKind::none) &&
              ETCM_KIND_NODE == static_cast<int>(VertexKind::node) &&
              ETCM_KIND_STEINER == static_cast<int>(VertexKind::steiner));

void etcm_error_detail(const etcm_mesh_t* mesh, etcm_error_detail_t* detail) {
  *detail = as<etcm_error_detail_t>(mesh_of(mesh).error_detail());
}

uint32_t etcm_node_count(const etcm_mesh_t* mesh) { return mesh_of(mesh).node_count(); }
uint32_t etcm_steiner_count(const etcm_mesh_t* mesh) { return mesh_of(mesh).steiner_count(); }
uint32_t etcm_feature_count(const etcm_mesh_t* mesh) { return mesh_of(mesh).feature_count(); }
uint32_t etcm_triangle_count(const etcm_mesh_t* mesh) { return mesh_of(mesh).triangle_count(); }
uint32_t etcm_finite_triangle_count(const etcm_mesh_t* mesh) {
  return mesh_of(mesh).finite_triangle_count();
}
uint32_t etcm_unresolved(const etcm_mesh_t* mesh) { return mesh_of(mesh).unresolved(); }
uint32_t etcm_vertex_id_end(const etcm_mesh_t* mesh) { return mesh_of(mesh).vertex_id_end(); }
uint32_t etcm_feature_id_end(const etcm_mesh_t* mesh) { return mesh_of(mesh).feature_id_end(); }

etcm_kind_t etcm_kind(const etcm_mesh_t* mesh, etcm_vertex_t vertex) {
  return static_cast<etcm_kind_t>(mesh_of(mesh).kind(VertexId{vertex}));
}

etcm_point_t etcm_point(const etcm_mesh_t* mesh, etcm_vertex_t vertex) {
  return as<etcm_point_t>(mesh_of(mesh).point(VertexId{vertex}));
}

etcm_position_t etcm_position(const etcm_mesh_t* mesh, etcm_vertex_t node) {
  return as<etcm_position_t>(mesh_of(mesh).position(VertexId{node}));
}

etcm_feature_t etcm_feature_of(const etcm_mesh_t* mesh, etcm_vertex_t steiner) {
  return number(mesh_of(mesh).feature_of(VertexId{steiner}));
}

uint32_t etcm_neighbours(const etcm_mesh_t* mesh, etcm_vertex_t vertex, etcm_neighbour_t* out,
                         size_t room) {
  return mesh_of(mesh).neighbours(VertexId{vertex}, list<Neighbour>(out, room));
}

void etcm_triangle(const etcm_mesh_t* mesh, etcm_triangle_id_t id, etcm_triangle_t* triangle) {
  *triangle = as<etcm_triangle_t>(mesh_of(mesh).triangle(TriangleId{id}));
}

bool etcm_is_feature(const etcm_mesh_t* mesh, etcm_feature_t feature) {
  return mesh_of(mesh).is_feature(FeatureId{feature});
}

etcm_feature_ends_t etcm_ends(const etcm_mesh_t* mesh, etcm_feature_t feature) {
  return as<etcm_feature_ends_t>(mesh_of(mesh).ends(FeatureId{feature}));
}

uint32_t etcm_chain(const etcm_mesh_t* mesh, etcm_feature_t feature, etcm_vertex_t* out,
                    size_t room) {
  return mesh_of(mesh).chain(FeatureId{feature}, list<VertexId>(out, room));
}

uint64_t etcm_hash(const etcm_mesh_t* mesh) { return mesh_of(mesh).hash(); }

bool etcm_nodes_of(const etcm_mesh_t* mesh, bool (*visit)(void* context, etcm_vertex_t node),
                   void* context) {
  for (const VertexId node : nodes_of(mesh_of(mesh))) {
    if (!plain(visit)(context, node.value)) return false;
  }
  return true;
}

bool etcm_features_of(const etcm_mesh_t* mesh, bool (*visit)(void* context, etcm_feature_t feature),
                      void* context) {
  for (const FeatureId feature : features_of(mesh_of(mesh))) {
    if (!plain(visit)(context, feature.value)) return false;
  }
  return true;
}

bool etcm_edges_of(const etcm_mesh_t* mesh, bool (*visit)(void* context, const etcm_edge_t* edge),
                   void* context) {
  for (const MeshEdge edge : edges_of(mesh_of(mesh))) {
    const auto seen = as<etcm_edge_t>(edge);
    if (!plain(visit)(context, &seen)) return false;
  }
  return true;
}
