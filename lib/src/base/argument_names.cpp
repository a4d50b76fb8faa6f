#include "etcm/illegal_argument.h"

namespace etcm {
inline namespace ETCM_IDS {

const char* to_string(Call call) noexcept {
  switch (call) {
    case Call::open:
      return "open";
    case Call::clear:
      return "clear";
    case Call::build:
      return "build";
    case Call::restore:
      return "restore";
    case Call::rebuild:
      return "rebuild";
    case Call::least_steiner:
      return "least_steiner";
    case Call::optimise:
      return "optimise";
    case Call::canonicalize:
      return "canonicalize";
    case Call::is_canonical:
      return "is_canonical";
    case Call::join:
      return "join";
    case Call::leave:
      return "leave";
    case Call::move:
      return "move";
    case Call::add_feature:
      return "add_feature";
    case Call::remove_feature:
      return "remove_feature";
    case Call::config:
      return "config";
    case Call::node_count:
      return "node_count";
    case Call::steiner_count:
      return "steiner_count";
    case Call::feature_count:
      return "feature_count";
    case Call::triangle_count:
      return "triangle_count";
    case Call::finite_triangle_count:
      return "finite_triangle_count";
    case Call::unresolved:
      return "unresolved";
    case Call::vertex_id_end:
      return "vertex_id_end";
    case Call::feature_id_end:
      return "feature_id_end";
    case Call::error_detail:
      return "error_detail";
    case Call::kind:
      return "kind";
    case Call::point:
      return "point";
    case Call::position:
      return "position";
    case Call::feature_of:
      return "feature_of";
    case Call::neighbours:
      return "neighbours";
    case Call::triangle:
      return "triangle";
    case Call::is_feature:
      return "is_feature";
    case Call::ends:
      return "ends";
    case Call::chain:
      return "chain";
    case Call::hash:
      return "hash";
    case Call::audit:
      return "audit";
    case Call::locate:
      return "locate";
    case Call::label_domain:
      return "label_domain";
    case Call::links:
      return "links";
    case Call::links_at:
      return "links_at";
    case Call::connectivity:
      return "connectivity";
    case Call::relays:
      return "relays";
    case Call::barrier_gaps:
      return "barrier_gaps";
    case Call::coverage_holes:
      return "coverage_holes";
    case Call::interpolate:
      return "interpolate";
    case Call::nearest_node:
      return "nearest_node";
    case Call::nearest_nodes:
      return "nearest_nodes";
    case Call::nodes_within:
      return "nodes_within";
    case Call::features_at:
      return "features_at";
    case Call::feature_between:
      return "feature_between";
    case Call::work_needed:
      return "work_needed";
    case Call::handles:
      return "handles";
    case Call::dry_run:
      return "dry_run";
    case Call::work_used:
      return "work_used";
    case Call::seal:
      return "seal";
    case Call::attach:
      return "attach";
    case Call::saved_bytes:
      return "saved_bytes";
    case Call::save:
      return "save";
    case Call::load:
      return "load";
    case Call::policy:
      return "policy";
  }
  return "unknown";
}

const char* to_string(Fault fault) noexcept {
  switch (fault) {
    case Fault::not_open:
      return "the mesh is not open";
    case Fault::bad_storage:
      return "storage is null or not aligned to 8";
    case Fault::no_vertex:
      return "no such vertex";
    case Fault::no_triangle:
      return "no such triangle";
    case Fault::no_feature:
      return "no such feature";
    case Fault::zero_range:
      return "the range is 0";
    case Fault::no_region:
      return "a triangle has no region";
    case Fault::has_features:
      return "the mesh has features";
    case Fault::in_callback:
      return "called from within a change";
    case Fault::outside:
      return "the split is outside of the subsegment";
  }
  return "unknown";
}

}  // namespace ETCM_IDS
}  // namespace etcm
