// What a call can answer. Errors are values; a failed call leaves the mesh as it was, but for what
// the head of mesh.h excepts.
#pragma once

#include <cstdint>

#include "etcm/id_width.h"

namespace etcm {
inline namespace ETCM_IDS {

// The numbers are promised for good, here and in C (etcm.h): they are in logs and on wires. A new
// answer takes the next number, wherever its line stands.
enum class [[nodiscard]] Status : std::uint8_t{
    ok = 0,

    // --- The arguments

    bad_config = 1,             // no vertices, no policy, or more than the id width can count
    storage_too_small = 2,      // fewer bytes than storage_bytes(config), or than Handles::words()
    bad_coordinate = 3,         // |x| or |y| is above position_max
    duplicate_vertex = 4,       // another node stands exactly there
    unknown_vertex = 5,         // the id names no node
    unknown_feature = 6,        // the id names no feature
    stale_handle = 7,           // what the handle stood for has gone, or came by other means
    zero_length_feature = 8,    // both endpoints are one node
    repeated_feature = 9,       // a feature between these endpoints exists
    overlapping_features = 10,  // the feature would run along a part of another
    crossing_features = 11,     // the feature would cross, or touch the inside of, another
                                // (unless a node stands there)
    endpoint_in_use = 12,       // the node is the endpoint of a feature and cannot leave
    mesh_not_empty = 13,        // build(), restore() and load() need an empty mesh
    mesh_unresolved = 14,       // build() left features unresolved: open() with more room goes on,
                                // or clear() and fewer features (Mesh::build());
                                // of restore(): a feature would be, and the mesh is empty
    buffer_too_small = 15,      // a span of the caller's is shorter than the call needs

    // --- Bytes that should be a mesh (storage.h)

    not_a_mesh = 22,        // they begin otherwise
    wrong_version = 23,     // a version made them whose layout or format is another
    wrong_byte_order = 24,  // the machine that made them has another order of bytes
    wrong_id_width = 25,    // they have ids of another width
    damaged = 26,           // they contradict themselves or their checksum, or are cut off

    // --- Room and bounds: normal answers, the mesh is as it was; but build() leaves what it has
    // done where conforming finds no room, no budget or no grid point (unresolved())

    out_of_vertices = 16,  // the vertex capacity is used up
    out_of_features = 17,  // the feature capacity is used up (a feature needs one place for each
                           // segment between the nodes it runs through)
    out_of_handles = 18,   // each number of a handle has been given once
    steiner_budget = 19,   // conforming would need more Steiner vertices than config.steiner_max
    work_limit = 20,       // the call would need more work than its limit
    grid_exhausted = 21,   // a segment is so short that no grid point on it can split it
};

// The name of the code, such as "crossing_features". Never null.
[[nodiscard]] const char* to_string(Status status) noexcept;

// One sentence for a person: what is wrong and what to do. Never null.
[[nodiscard]] const char* explain(Status status) noexcept;

}  // namespace ETCM_IDS
}  // namespace etcm
