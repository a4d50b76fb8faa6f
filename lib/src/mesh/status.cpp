#include "etcm/status.h"

namespace etcm {
inline namespace ETCM_IDS {

namespace {

struct Text {
  const char* name;
  const char* sentence;
};

// A switch without a default: the compiler names the code that was forgotten.
Text text_of(Status status) noexcept {
  switch (status) {
    case Status::ok:
      return {"ok", "The call succeeded."};
    case Status::bad_config:
      return {"bad_config",
              "The configuration has no vertices or no policy, or exceeds what the id width can "
              "count or memory hold; compare it with vertices_limit and features_limit."};
    case Status::storage_too_small:
      return {"storage_too_small",
              "The storage has fewer bytes than storage_bytes(config), or fewer numbers than "
              "Handles::words(config) asks for; give it more, or lower the capacities."};
    case Status::bad_coordinate:
      return {"bad_coordinate",
              "A coordinate is beyond 16777216 (2^24) units from 0; use a coarser unit or a nearer "
              "origin."};
    case Status::duplicate_vertex:
      return {"duplicate_vertex", "Another node stands exactly there; remove or move one of them."};
    case Status::unknown_vertex:
      return {"unknown_vertex", "The id names no node of this mesh; it may have left."};
    case Status::unknown_feature:
      return {"unknown_feature", "The id names no feature of this mesh; it may have been removed."};
    case Status::stale_handle:
      return {"stale_handle",
              "The node or feature of the handle has gone, or the mesh was made anew; ask for a "
              "handle of what stands."};
    case Status::zero_length_feature:
      return {"zero_length_feature",
              "Both endpoints of the feature are one node; a feature needs two."};
    case Status::repeated_feature:
      return {"repeated_feature", "A feature between these two nodes exists already; keep one."};
    case Status::overlapping_features:
      return {"overlapping_features",
              "The feature would run along a part of another; split both at their nodes and keep "
              "each segment once."};
    case Status::crossing_features:
      return {"crossing_features",
              "The feature would cross or touch the inside of another; put a node where they "
              "meet."};
    case Status::endpoint_in_use:
      return {"endpoint_in_use",
              "The node is the endpoint of a feature and cannot leave; remove the feature first."};
    case Status::mesh_not_empty:
      return {"mesh_not_empty",
              "Building, restoring and loading need an empty mesh; clear it first."};
    case Status::buffer_too_small:
      return {"buffer_too_small",
              "A buffer that the call was given is shorter than it needs; pass one as long as the "
              "call's header says."};
    case Status::mesh_unresolved:
      return {"mesh_unresolved",
              "Not every feature is a union of edges: after a build that had too little room, "
              "clear the "
              "mesh and give it more; where a mesh is restored, give all its Steiner vertices."};
    case Status::not_a_mesh:
      return {"not_a_mesh",
              "The bytes do not begin as those of a mesh do; look where they come from."};
    case Status::wrong_version:
      return {"wrong_version",
              "Another version of the library made the bytes: what is loaded needs one that is not "
              "older; what is attached needs the same, so save the mesh there, and load it here."};
    case Status::wrong_byte_order:
      return {
          "wrong_byte_order",
          "The machine that made them has another order of bytes; save the mesh there, and load "
          "it here."};
    case Status::wrong_id_width:
      return {"wrong_id_width",
              "The ids in the bytes have another width; save the mesh there, and load it here."};
    case Status::damaged:
      return {"damaged",
              "The bytes are not as they were written; take another copy of a mesh at rest."};
    case Status::out_of_vertices:
      return {"out_of_vertices",
              "The vertex capacity is used up by nodes and Steiner vertices; raise vertices_max."};
    case Status::out_of_features:
      return {"out_of_features",
              "The feature capacity is used up, each segment from node to node taking one; raise "
              "features_max."};
    case Status::out_of_handles:
      return {"out_of_handles",
              "Each number of a handle has been given once; drop all handles and open them anew."};
    case Status::steiner_budget:
      return {"steiner_budget",
              "The features need more Steiner vertices than steiner_max allows; raise it or "
              "simplify them."};
    case Status::work_limit:
      return {"work_limit", "The change needs more work than its limit allows; raise the limit."};
    case Status::grid_exhausted:
      return {"grid_exhausted",
              "A subsegment is too short for a further grid point to split it; move the crowded "
              "nodes apart or use a finer unit."};
  }
  return {"unknown_status", "The value is no status of this library."};
}

}  // namespace

const char* to_string(Status status) noexcept { return text_of(status).name; }

const char* explain(Status status) noexcept { return text_of(status).sentence; }

}  // namespace ETCM_IDS
}  // namespace etcm
