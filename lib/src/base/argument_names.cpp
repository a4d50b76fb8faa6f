#include "base/texts.h"
#include "etcm/illegal_argument.h"

namespace etcm {
inline namespace ETCM_IDS {
namespace {

// In the order of the numbers, and one for what is none.
constexpr char call_names[] =
    "open\0"
    "clear\0"
    "build\0"
    "restore\0"
    "rebuild\0"
    "join\0"
    "leave\0"
    "move\0"
    "add_feature\0"
    "remove_feature\0"
    "config\0"
    "node_count\0"
    "steiner_count\0"
    "feature_count\0"
    "triangle_count\0"
    "finite_triangle_count\0"
    "unresolved\0"
    "vertex_id_end\0"
    "feature_id_end\0"
    "error_detail\0"
    "kind\0"
    "point\0"
    "position\0"
    "feature_of\0"
    "neighbours\0"
    "triangle\0"
    "is_feature\0"
    "ends\0"
    "chain\0"
    "hash\0"
    "audit\0"
    "locate\0"
    "label_domain\0"
    "links\0"
    "links_at\0"
    "connectivity\0"
    "relays\0"
    "barrier_gaps\0"
    "coverage_holes\0"
    "interpolate\0"
    "canonicalize\0"
    "is_canonical\0"
    "nearest_node\0"
    "nearest_nodes\0"
    "nodes_within\0"
    "features_at\0"
    "feature_between\0"
    "optimise\0"
    "least_steiner\0"
    "work_needed\0"
    "handles\0"
    "dry_run\0"
    "work_used\0"
    "seal\0"
    "attach\0"
    "saved_bytes\0"
    "save\0"
    "load\0"
    "policy\0"
    "unknown";
constexpr char fault_names[] =
    "the mesh is not open\0"
    "storage is null or not aligned to 8\0"
    "no such vertex\0"
    "no such triangle\0"
    "no such feature\0"
    "the range is 0\0"
    "a triangle has no region\0"
    "the mesh has features\0"
    "called from within a change\0"
    "the split is outside of the subsegment\0"
    "unknown";
static_assert(internal::text_count(call_names) == static_cast<std::size_t>(Call::policy) + 2);
static_assert(internal::text_count(fault_names) == static_cast<std::size_t>(Fault::outside) + 2);

template <class Number>
const char* name_of(const char* names, Number value, Number last) noexcept {
  return internal::nth_text(names, static_cast<std::size_t>(value),
                            static_cast<std::size_t>(last) + 1);
}

}  // namespace

const char* to_string(Call call) noexcept { return name_of(call_names, call, Call::policy); }

const char* to_string(Fault fault) noexcept { return name_of(fault_names, fault, Fault::outside); }

}  // namespace ETCM_IDS
}  // namespace etcm
