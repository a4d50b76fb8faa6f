// What a call can answer. Errors are values; a failed call leaves the mesh as it was.
#pragma once

#include <cstdint>

#include "etcm/id_width.h"

namespace etcm {
inline namespace ETCM_IDS {

enum class [[nodiscard]] Status : std::uint8_t{
    ok,
    // The arguments.
    bad_config,            // the configuration contradicts itself or the id width
    storage_too_small,     // fewer bytes than storage_bytes(config)
    bad_coordinate,        // |x| or |y| is above position_max
    duplicate_vertex,      // another node stands exactly there
    unknown_vertex,        // the id names no node
    unknown_feature,       // the id names no feature
    zero_length_feature,   // both endpoints are one node
    repeated_feature,      // a feature between these endpoints exists
    overlapping_features,  // the feature would run along a part of another
    crossing_features,     // the feature would cross, or touch the inside of, another
                           // (unless a node stands there)
    endpoint_in_use,       // the node is the endpoint of a feature and cannot leave
    mesh_not_empty,        // build() needs an empty mesh
    mesh_unresolved,       // build() left features unresolved; only clear() goes on from there
    buffer_too_small,      // the caller's output span is shorter than the count returned
    // Room and bounds: normal answers, the mesh is whole.
    out_of_vertices,  // the vertex capacity is used up
    out_of_features,  // the feature capacity is used up (a feature needs one place for each
                      // segment between the nodes it runs through)
    steiner_budget,   // conforming would need more Steiner vertices than config.steiner_max
    work_limit,       // the call would need more work than its limit
    grid_exhausted,   // a segment is so short that no grid point on it can split it
};

// The name of the code, such as "crossing_features". Never null.
[[nodiscard]] const char* to_string(Status status) noexcept;

// One sentence for a person: what is wrong and what to do. Never null.
[[nodiscard]] const char* explain(Status status) noexcept;

}  // namespace ETCM_IDS
}  // namespace etcm
