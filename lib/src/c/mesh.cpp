#include "etcm/c/mesh.h"

#include "c/policy.h"
#include "c/same.h"
#include "etcm/policy.h"
#include "etcm/storage.h"

using namespace etcm;
using namespace etcm::c;

static_assert(ETCM_VERTICES_LIMIT == vertices_limit && ETCM_FEATURES_LIMIT == features_limit);
static_assert(ETCM_POSITION_MAX == position_max && ETCM_SUBUNITS_PER_UNIT == subunits_per_unit &&
              ETCM_SUBUNIT_BITS == subunit_bits);
static_assert(ETCM_NONE == VertexId::none_value && ETCM_INFINITE == infinite_vertex.value);
constexpr bool has_capacity_for(std::uint32_t nodes, std::uint32_t features) noexcept {
  const MeshConfig config = capacity_for(nodes, features);
  return ETCM_VERTICES_FOR(nodes, features) == config.vertices_max &&
         ETCM_SEGMENTS_FOR(features) == config.features_max;
}
static_assert(has_capacity_for(0, 0) && has_capacity_for(1, 1) && has_capacity_for(200, 20) &&
              has_capacity_for(255, 3) && has_capacity_for(256, 3) && has_capacity_for(3000, 30));
static_assert(ETCM_UNLIMITED == Work::unlimited().units);
static_assert(ETCM_KEEP_ALIVE_UNITS == KeepAlive::units_between);

ETCM_SAME_MEMBER(Position, etcm_position_t, x, x);
ETCM_SAME_MEMBER(Position, etcm_position_t, y, y);
ETCM_SAME_MEMBER(Point, etcm_point_t, x, x);
ETCM_SAME_MEMBER(Point, etcm_point_t, y, y);
ETCM_SAME_MEMBER(FeatureEnds, etcm_feature_ends_t, from, from);
ETCM_SAME_MEMBER(FeatureEnds, etcm_feature_ends_t, to, to);
ETCM_SAME_MEMBER(SteinerPlace, etcm_steiner_place_t, feature, feature);
ETCM_SAME_MEMBER(SteinerPlace, etcm_steiner_place_t, point, point);

namespace {

// The configuration that the library sees: a policy of C's is called by one of the library's.
MeshConfig config_of(const etcm_config_t& config) noexcept {
  MeshConfig own{.vertices_max = config.vertices_max,
                 .features_max = config.features_max,
                 .steiner_max = config.steiner_max};
  if (config.policy != nullptr) set_policy(own, *config.policy);
  return own;
}

}  // namespace

etcm_status_t etcm_validate(const etcm_config_t* config) {
  return number(validate(config_of(*config)));
}

void etcm_capacity_for(uint32_t nodes, uint32_t features, etcm_config_t* config) {
  const MeshConfig own = capacity_for(nodes, features);
  *config = {own.vertices_max, own.features_max, 0, nullptr};
}

size_t etcm_storage_bytes(uint32_t vertices_max, uint32_t features_max) {
  return storage_bytes(vertices_max, features_max);
}

size_t etcm_saved_bytes_most(uint32_t vertices_max, uint32_t features_max) {
  return saved_bytes_most(vertices_max, features_max);
}

etcm_status_t etcm_open(etcm_mesh_t* mesh, void* storage, size_t bytes,
                        const etcm_config_t* config) {
  return number(mesh_of(mesh).open({static_cast<std::byte*>(storage), bytes}, config_of(*config)));
}

void etcm_clear(etcm_mesh_t* mesh) { mesh_of(mesh).clear(); }

etcm_status_t etcm_build(etcm_mesh_t* mesh, const etcm_position_t* nodes, size_t node_count,
                         const etcm_feature_ends_t* features, size_t feature_count,
                         uint64_t limit) {
  return number(mesh_of(mesh).build(list<const Position>(nodes, node_count),
                                    list<const FeatureEnds>(features, feature_count), Work{limit}));
}

etcm_status_t etcm_build_measured(etcm_mesh_t* mesh, const etcm_position_t* nodes,
                                  size_t node_count, const etcm_feature_ends_t* features,
                                  size_t feature_count, uint64_t limit,
                                  void (*nodes_stand)(void* context), void* context) {
  struct Told {
    void (*nodes_stand)(void* context);
    void* context;
  } told{nodes_stand, context};
  return number(mesh_of(mesh).build(
      list<const Position>(nodes, node_count), list<const FeatureEnds>(features, feature_count),
      Work{limit},
      [](void* to) noexcept {
        const Told& of = *static_cast<const Told*>(to);
        plain(of.nodes_stand)(of.context);
      },
      &told));
}

etcm_status_t etcm_restore(etcm_mesh_t* mesh, const etcm_position_t* nodes, size_t node_count,
                           const etcm_feature_ends_t* features, size_t feature_count,
                           const etcm_steiner_place_t* steiner, size_t steiner_count,
                           uint64_t limit) {
  return number(mesh_of(mesh).restore(
      list<const Position>(nodes, node_count), list<const FeatureEnds>(features, feature_count),
      list<const SteinerPlace>(steiner, steiner_count), Work{limit}));
}

etcm_status_t etcm_canonicalize(etcm_mesh_t* mesh, uint64_t limit) {
  return number(mesh_of(mesh).canonicalize(Work{limit}));
}

bool etcm_is_canonical(const etcm_mesh_t* mesh) { return mesh_of(mesh).is_canonical(); }

etcm_status_t etcm_rebuild(etcm_mesh_t* mesh, uint64_t limit) {
  return number(mesh_of(mesh).rebuild(Work{limit}));
}

etcm_status_t etcm_optimise(etcm_mesh_t* mesh, uint32_t trials, uint32_t first_trial,
                            uint64_t limit) {
  return number(mesh_of(mesh).optimise(trials, first_trial, Work{limit}));
}

etcm_status_t etcm_join(etcm_mesh_t* mesh, etcm_position_t position, uint64_t limit,
                        etcm_vertex_t* node) {
  VertexId id;
  const Status status = mesh_of(mesh).join(as<Position>(position), id, Work{limit});
  if (status == Status::ok) *node = id.value;
  return number(status);
}

etcm_status_t etcm_leave(etcm_mesh_t* mesh, etcm_vertex_t node, uint64_t limit) {
  return number(mesh_of(mesh).leave(VertexId{node}, Work{limit}));
}

etcm_status_t etcm_move(etcm_mesh_t* mesh, etcm_vertex_t node, etcm_position_t position,
                        uint64_t limit) {
  return number(mesh_of(mesh).move(VertexId{node}, as<Position>(position), Work{limit}));
}

etcm_status_t etcm_add_feature(etcm_mesh_t* mesh, etcm_vertex_t from, etcm_vertex_t to,
                               uint64_t limit, etcm_feature_t* feature) {
  FeatureId id;
  const Status status = mesh_of(mesh).add_feature({VertexId{from}, VertexId{to}}, id, Work{limit});
  if (status == Status::ok) *feature = id.value;
  return number(status);
}

etcm_status_t etcm_remove_feature(etcm_mesh_t* mesh, etcm_feature_t feature, uint64_t limit) {
  return number(mesh_of(mesh).remove_feature(FeatureId{feature}, Work{limit}));
}

void etcm_keep_alive(etcm_mesh_t* mesh, void (*call)(void* context), void* context) {
  mesh_of(mesh).keep_alive({plain(call), context});
}

uint64_t etcm_work_used(const etcm_mesh_t* mesh) { return mesh_of(mesh).work_used().units; }
uint64_t etcm_work_needed(const etcm_mesh_t* mesh) { return mesh_of(mesh).work_needed().units; }

void etcm_config(const etcm_mesh_t* mesh, etcm_config_t* config) {
  const MeshConfig& own = mesh_of(mesh).config();
  *config = {own.vertices_max, own.features_max, own.steiner_max, policy_of(own)};
}
