#include "etcm/status.h"

#include "base/texts.h"

namespace etcm {
inline namespace ETCM_IDS {
namespace {

// Of each status its name and a sentence, in the order of the numbers.
constexpr char status_texts[] =
    "ok\0"
    "The call succeeded.\0"
    "bad_config\0"
    "The configuration has no vertices or no policy, or exceeds what the id width can count "
    "or memory hold; compare it with vertices_limit and features_limit.\0"
    "storage_too_small\0"
    "The storage has fewer bytes than storage_bytes(config), or fewer numbers than "
    "Handles::words(config) asks for; give it more, or lower the capacities.\0"
    "bad_coordinate\0"
    "A coordinate is beyond 16777216 (2^24) units from 0; use a coarser unit or a nearer "
    "origin.\0"
    "duplicate_vertex\0"
    "Another node stands exactly there; remove or move one of them.\0"
    "unknown_vertex\0"
    "The id names no node of this mesh; it may have left.\0"
    "unknown_feature\0"
    "The id names no feature of this mesh; it may have been removed.\0"
    "stale_handle\0"
    "The node or feature of the handle has gone, or the mesh was made anew; ask for a handle "
    "of what stands.\0"
    "zero_length_feature\0"
    "Both endpoints of the feature are one node; a feature needs two.\0"
    "repeated_feature\0"
    "A feature between these two nodes exists already; keep one.\0"
    "overlapping_features\0"
    "The feature would run along a part of another; split both at their nodes and keep each "
    "segment once.\0"
    "crossing_features\0"
    "The feature would cross or touch the inside of another; put a node where they meet.\0"
    "endpoint_in_use\0"
    "The node is the endpoint of a feature and cannot leave; remove the feature first.\0"
    "mesh_not_empty\0"
    "Building, restoring and loading need an empty mesh; clear it first.\0"
    "mesh_unresolved\0"
    "Not every feature is a union of edges: after a build that had too little room, open the "
    "mesh with more, or give fewer features; where a mesh is restored, give all its Steiner "
    "vertices.\0"
    "buffer_too_small\0"
    "A buffer that the call was given is shorter than it needs; pass one as long as the "
    "call's header says.\0"
    "out_of_vertices\0"
    "The vertex capacity is used up by nodes and Steiner vertices; raise vertices_max.\0"
    "out_of_features\0"
    "The feature capacity is used up, each segment from node to node taking one; raise "
    "features_max.\0"
    "out_of_handles\0"
    "Each number of a handle has been given once; drop all handles and open them anew.\0"
    "steiner_budget\0"
    "The features need more Steiner vertices than steiner_max allows; raise it or simplify "
    "them.\0"
    "work_limit\0"
    "The change needs more work than its limit allows; raise the limit.\0"
    "grid_exhausted\0"
    "A subsegment is too short for a further grid point to split it; move the crowded nodes "
    "apart or use a finer unit.\0"
    "not_a_mesh\0"
    "The bytes do not begin as those of a mesh do; look where they come from.\0"
    "wrong_version\0"
    "Another version of the library made the bytes: what is loaded needs one that is not "
    "older; what is attached needs the same, so save the mesh there, and load it here.\0"
    "wrong_byte_order\0"
    "The machine that made them has another order of bytes; save the mesh there, and load it "
    "here.\0"
    "wrong_id_width\0"
    "The ids in the bytes have another width; save the mesh there, and load it here.\0"
    "damaged\0"
    "The bytes are not as they were written; take another copy of a mesh at rest.\0"
    "unknown_status\0"
    "The value is no status of this library.";
constexpr std::size_t known_statuses = static_cast<std::size_t>(Status::damaged) + 1;
static_assert(internal::text_count(status_texts) == 2 * (known_statuses + 1));

// A name and a sentence for each.
const char* text_of(Status status, std::size_t which) noexcept {
  return internal::nth_text(status_texts, 2 * static_cast<std::size_t>(status) + which,
                            2 * known_statuses + which);
}

}  // namespace

const char* to_string(Status status) noexcept { return text_of(status, 0); }

const char* explain(Status status) noexcept { return text_of(status, 1); }

}  // namespace ETCM_IDS
}  // namespace etcm
