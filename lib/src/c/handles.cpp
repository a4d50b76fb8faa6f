#include "etcm/c/handles.h"

#include <new>

#include "c/same.h"
#include "etcm/dry_run.h"
#include "etcm/handles.h"

using namespace etcm;
using namespace etcm::c;

ETCM_SAME_MEMBER(NodeHandle, etcm_node_handle_t, id, id);
ETCM_SAME_MEMBER(NodeHandle, etcm_node_handle_t, number, number);
ETCM_SAME_MEMBER(FeatureHandle, etcm_feature_handle_t, id, id);
ETCM_SAME_MEMBER(FeatureHandle, etcm_feature_handle_t, number, number);
ETCM_SAME_MEMBER(Outcome, etcm_outcome_t, status, status);
ETCM_SAME_MEMBER(Outcome, etcm_outcome_t, detail, detail);
ETCM_SAME_MEMBER(Outcome, etcm_outcome_t, steiner, steiner);
ETCM_SAME_MEMBER(Outcome, etcm_outcome_t, work, work);
static_assert(is_same_memory<Handles, etcm_handles_t>);

namespace {

Handles& handles_in(etcm_handles_t* handles) noexcept {
  return *reinterpret_cast<Handles*>(handles);
}
const Handles& handles_in(const etcm_handles_t* handles) noexcept {
  return *reinterpret_cast<const Handles*>(handles);
}

void tell(etcm_outcome_t* outcome, const Outcome& told) noexcept {
  *outcome = as<etcm_outcome_t>(told);
}

}  // namespace

etcm_status_t etcm_handles_open(etcm_handles_t* handles, etcm_mesh_t* mesh, uint32_t* numbers,
                                size_t number_count, uint32_t given_out) {
  Handles& made = *::new (handles) Handles;
  return number(made.open(mesh_of(mesh), {numbers, number_count}, given_out));
}

uint32_t etcm_handles_given_out(const etcm_handles_t* handles) {
  return handles_in(handles).given_out();
}

etcm_status_t etcm_handles_find_node(const etcm_handles_t* handles, etcm_node_handle_t node,
                                     etcm_vertex_t* id) {
  VertexId found;
  const Status status = handles_in(handles).find(as<NodeHandle>(node), found);
  if (status == Status::ok) *id = found.value;
  return number(status);
}

etcm_status_t etcm_handles_find_feature(const etcm_handles_t* handles,
                                        etcm_feature_handle_t feature, etcm_feature_t* id) {
  FeatureId found;
  const Status status = handles_in(handles).find(as<FeatureHandle>(feature), found);
  if (status == Status::ok) *id = found.value;
  return number(status);
}

etcm_status_t etcm_handles_of_node(etcm_handles_t* handles, etcm_vertex_t id,
                                   etcm_node_handle_t* node) {
  NodeHandle found;
  const Status status = handles_in(handles).handle_of(VertexId{id}, found);
  if (status == Status::ok) *node = as<etcm_node_handle_t>(found);
  return number(status);
}

etcm_status_t etcm_handles_of_feature(etcm_handles_t* handles, etcm_feature_t id,
                                      etcm_feature_handle_t* feature) {
  FeatureHandle found;
  const Status status = handles_in(handles).handle_of(FeatureId{id}, found);
  if (status == Status::ok) *feature = as<etcm_feature_handle_t>(found);
  return number(status);
}

etcm_status_t etcm_handles_join(etcm_handles_t* handles, etcm_position_t position, uint64_t limit,
                                etcm_node_handle_t* node) {
  NodeHandle given;
  const Status status = handles_in(handles).join(as<Position>(position), given, Work{limit});
  if (status == Status::ok) *node = as<etcm_node_handle_t>(given);
  return number(status);
}

etcm_status_t etcm_handles_leave(etcm_handles_t* handles, etcm_node_handle_t node, uint64_t limit) {
  return number(handles_in(handles).leave(as<NodeHandle>(node), Work{limit}));
}

etcm_status_t etcm_handles_move(etcm_handles_t* handles, etcm_node_handle_t node,
                                etcm_position_t position, uint64_t limit) {
  return number(
      handles_in(handles).move(as<NodeHandle>(node), as<Position>(position), Work{limit}));
}

etcm_status_t etcm_handles_add_feature(etcm_handles_t* handles, etcm_node_handle_t from,
                                       etcm_node_handle_t to, uint64_t limit,
                                       etcm_feature_handle_t* feature) {
  FeatureHandle given;
  const Status status =
      handles_in(handles).add_feature(as<NodeHandle>(from), as<NodeHandle>(to), given, Work{limit});
  if (status == Status::ok) *feature = as<etcm_feature_handle_t>(given);
  return number(status);
}

etcm_status_t etcm_handles_remove_feature(etcm_handles_t* handles, etcm_feature_handle_t feature,
                                          uint64_t limit) {
  return number(handles_in(handles).remove_feature(as<FeatureHandle>(feature), Work{limit}));
}

void etcm_dry_run_join(etcm_mesh_t* mesh, etcm_position_t position, uint64_t limit,
                       etcm_outcome_t* outcome) {
  tell(outcome, DryRun(mesh_of(mesh)).join(as<Position>(position), Work{limit}));
}

void etcm_dry_run_leave(etcm_mesh_t* mesh, etcm_vertex_t node, uint64_t limit,
                        etcm_outcome_t* outcome) {
  tell(outcome, DryRun(mesh_of(mesh)).leave(VertexId{node}, Work{limit}));
}

void etcm_dry_run_move(etcm_mesh_t* mesh, etcm_vertex_t node, etcm_position_t position,
                       uint64_t limit, etcm_outcome_t* outcome) {
  tell(outcome, DryRun(mesh_of(mesh)).move(VertexId{node}, as<Position>(position), Work{limit}));
}

void etcm_dry_run_add_feature(etcm_mesh_t* mesh, etcm_vertex_t from, etcm_vertex_t to,
                              uint64_t limit, etcm_outcome_t* outcome) {
  tell(outcome, DryRun(mesh_of(mesh)).add_feature({VertexId{from}, VertexId{to}}, Work{limit}));
}

void etcm_dry_run_remove_feature(etcm_mesh_t* mesh, etcm_feature_t feature, uint64_t limit,
                                 etcm_outcome_t* outcome) {
  tell(outcome, DryRun(mesh_of(mesh)).remove_feature(FeatureId{feature}, Work{limit}));
}
