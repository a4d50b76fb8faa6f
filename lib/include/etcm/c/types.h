// The vocabulary of the C interface: ids, coordinates, statuses, and what an illegal call does.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// How wide ids are, for the library and for all programs that use it: 32, or 16, which nearly
// halves the memory and holds up to 4094 vertices. A program and a library of two widths are not
// linked ("undefined reference to etcm_open_ids_16").
#ifndef ETCM_ID_BITS
#define ETCM_ID_BITS 32
#endif
#if ETCM_ID_BITS == 16
typedef uint16_t etcm_id_t;
#define ETCM_VERTICES_LIMIT 4094u
#define ETCM_FEATURES_LIMIT 8190u
#elif ETCM_ID_BITS == 32
typedef uint32_t etcm_id_t;
#define ETCM_VERTICES_LIMIT 268435454u
#define ETCM_FEATURES_LIMIT 268435454u
#else
#error "ETCM_ID_BITS must be 32 or 16"
#endif

// The id of nothing.
#define ETCM_NONE ((etcm_id_t)-1)

// Nodes and Steiner vertices share the ids from 1 up; the least that is free is given out first. So
// the same calls on the same mesh give the same ids on every machine; in another order, others
// (c/mesh.h).
typedef etcm_id_t etcm_vertex_t;
// The vertex at infinity: a triangle that has it as a corner is a ghost, behind an edge of the
// hull.
#define ETCM_INFINITE ((etcm_vertex_t)0)
// From 0 up; lasts until the feature is removed.
typedef etcm_id_t etcm_feature_t;
// 0 to etcm_triangle_count() - 1, ghosts among them; lasts until the next call that changes the
// mesh, or would have and was refused.
typedef etcm_id_t etcm_triangle_id_t;

// A warning where the answer is dropped.
#define ETCM_MUST_USE __attribute__((warn_unused_result))

// --- Coordinates

// A place in the user's unit, whatever that is; nodes stand on these. Legal while |x| and |y| are
// at most ETCM_POSITION_MAX.
typedef struct {
  int32_t x;
  int32_t y;
} etcm_position_t;
#define ETCM_POSITION_MAX 16777216

// A place in sub-units: 2^28 make one unit. Steiner vertices stand on these, exactly on their
// features. In a mesh |x| and |y| are at most 2^52.
typedef struct {
  int64_t x;
  int64_t y;
} etcm_point_t;
#define ETCM_SUBUNIT_BITS 28
#define ETCM_SUBUNITS_PER_UNIT INT64_C(268435456)

static inline bool etcm_in_range(etcm_position_t p) {
  return p.x >= -ETCM_POSITION_MAX && p.x <= ETCM_POSITION_MAX && p.y >= -ETCM_POSITION_MAX &&
         p.y <= ETCM_POSITION_MAX;
}

static inline etcm_point_t etcm_to_point(etcm_position_t p) {
  const etcm_point_t point = {p.x * ETCM_SUBUNITS_PER_UNIT, p.y * ETCM_SUBUNITS_PER_UNIT};
  return point;
}

// --- Statuses

// What a call answers. The numbers are promised for good: a later version adds, and changes none.
typedef uint8_t etcm_status_t;
enum {
  ETCM_OK = 0,

  // --- The arguments

  ETCM_BAD_CONFIG = 1,             // no vertices, a policy without a function, too wide for ids
  ETCM_STORAGE_TOO_SMALL = 2,      // fewer bytes than ETCM_STORAGE_BYTES(), or numbers of handles
  ETCM_BAD_COORDINATE = 3,         // |x| or |y| is above ETCM_POSITION_MAX
  ETCM_DUPLICATE_VERTEX = 4,       // another node stands exactly there
  ETCM_UNKNOWN_VERTEX = 5,         // the id names no node
  ETCM_UNKNOWN_FEATURE = 6,        // the id names no feature
  ETCM_STALE_HANDLE = 7,           // what the handle stood for has gone, or came by other means
  ETCM_ZERO_LENGTH_FEATURE = 8,    // both endpoints are one node
  ETCM_REPEATED_FEATURE = 9,       // a feature between these endpoints exists
  ETCM_OVERLAPPING_FEATURES = 10,  // the feature would run along a part of another
  ETCM_CROSSING_FEATURES = 11,     // it would cross, or touch the inside of, another
  ETCM_ENDPOINT_IN_USE = 12,       // the node is the endpoint of a feature and cannot leave
  ETCM_MESH_NOT_EMPTY = 13,        // etcm_build(), etcm_restore() and etcm_load() need an empty one
  ETCM_MESH_UNRESOLVED = 14,       // etcm_build() left features unresolved: etcm_open() with
                                   // more room goes on, or etcm_clear() and fewer features;
                                   // of etcm_restore(): one would be, and the mesh is empty
  ETCM_BUFFER_TOO_SMALL = 15,      // the caller's buffer is shorter than the call needs

  // --- Room and bounds: normal answers, the mesh is as it was; but etcm_build() leaves what it has
  // done where conforming finds no room, no budget or no grid point (etcm_unresolved())

  ETCM_OUT_OF_VERTICES = 16,  // the vertex capacity is used up
  ETCM_OUT_OF_FEATURES = 17,  // the feature capacity is (one place for each segment)
  ETCM_OUT_OF_HANDLES = 18,   // each number of a handle has been given once
  ETCM_STEINER_BUDGET = 19,   // more Steiner vertices would be needed than steiner_max
  ETCM_WORK_LIMIT = 20,       // more work would be needed than the limit of the call
  ETCM_GRID_EXHAUSTED = 21,   // a segment is so short that no grid point on it can split it

  // --- Bytes that should be a mesh (c/bytes.h)

  ETCM_NOT_A_MESH = 22,        // they begin otherwise
  ETCM_WRONG_VERSION = 23,     // a version made them whose layout or format is another
  ETCM_WRONG_BYTE_ORDER = 24,  // the machine that made them has another order of bytes
  ETCM_WRONG_ID_WIDTH = 25,    // they have ids of another width
  ETCM_DAMAGED = 26            // they contradict themselves or their checksum, or are cut off
};

// The name of a status, such as "crossing_features", and a sentence for a person: what is wrong and
// what to do. Never null.
const char* etcm_status_name(etcm_status_t status);
const char* etcm_explain(etcm_status_t status);

// --- Illegal arguments

// Which call it was. The numbers are promised for good.
typedef uint8_t etcm_call_t;
enum {
  ETCM_CALL_OPEN = 0,
  ETCM_CALL_CLEAR = 1,
  ETCM_CALL_BUILD = 2,
  ETCM_CALL_RESTORE = 3,
  ETCM_CALL_REBUILD = 4,
  ETCM_CALL_JOIN = 5,
  ETCM_CALL_LEAVE = 6,
  ETCM_CALL_MOVE = 7,
  ETCM_CALL_ADD_FEATURE = 8,
  ETCM_CALL_REMOVE_FEATURE = 9,
  ETCM_CALL_CONFIG = 10,
  ETCM_CALL_NODE_COUNT = 11,
  ETCM_CALL_STEINER_COUNT = 12,
  ETCM_CALL_FEATURE_COUNT = 13,
  ETCM_CALL_TRIANGLE_COUNT = 14,
  ETCM_CALL_FINITE_TRIANGLE_COUNT = 15,
  ETCM_CALL_UNRESOLVED = 16,
  ETCM_CALL_VERTEX_ID_END = 17,
  ETCM_CALL_FEATURE_ID_END = 18,
  ETCM_CALL_ERROR_DETAIL = 19,
  ETCM_CALL_KIND = 20,
  ETCM_CALL_POINT = 21,
  ETCM_CALL_POSITION = 22,
  ETCM_CALL_FEATURE_OF = 23,
  ETCM_CALL_NEIGHBOURS = 24,
  ETCM_CALL_TRIANGLE = 25,
  ETCM_CALL_IS_FEATURE = 26,
  ETCM_CALL_ENDS = 27,
  ETCM_CALL_CHAIN = 28,
  ETCM_CALL_HASH = 29,
  ETCM_CALL_AUDIT = 30,
  ETCM_CALL_LOCATE = 31,
  ETCM_CALL_LABEL_DOMAIN = 32,
  ETCM_CALL_LINKS = 33,
  ETCM_CALL_LINKS_AT = 34,
  ETCM_CALL_CONNECTIVITY = 35,
  ETCM_CALL_RELAYS = 36,
  ETCM_CALL_BARRIER_GAPS = 37,
  ETCM_CALL_COVERAGE_HOLES = 38,
  ETCM_CALL_INTERPOLATE = 39,
  ETCM_CALL_CANONICALIZE = 40,
  ETCM_CALL_IS_CANONICAL = 41,
  ETCM_CALL_NEAREST_NODE = 42,
  ETCM_CALL_NEAREST_NODES = 43,
  ETCM_CALL_NODES_WITHIN = 44,
  ETCM_CALL_FEATURES_AT = 45,
  ETCM_CALL_FEATURE_BETWEEN = 46,
  ETCM_CALL_OPTIMISE = 47,
  ETCM_CALL_LEAST_STEINER = 48,
  ETCM_CALL_WORK_NEEDED = 49,
  ETCM_CALL_HANDLES = 50,
  ETCM_CALL_DRY_RUN = 51,
  ETCM_CALL_WORK_USED = 52,
  ETCM_CALL_SEAL = 53,
  ETCM_CALL_ATTACH = 54,
  ETCM_CALL_SAVED_BYTES = 55,
  ETCM_CALL_SAVE = 56,
  ETCM_CALL_LOAD = 57,
  ETCM_CALL_POLICY = 58  // no call: a split policy of one's own, of what it has answered
};

// What was wrong with it. The numbers are promised for good.
typedef uint8_t etcm_fault_t;
enum {
  ETCM_FAULT_NOT_OPEN = 0,      // the mesh has no storage: etcm_open() was not called, or refused
  ETCM_FAULT_BAD_STORAGE = 1,   // null, or not aligned to 8
  ETCM_FAULT_NO_VERTEX = 2,     // the id is none, out of range or not in use (anymore)
  ETCM_FAULT_NO_TRIANGLE = 3,   // none or out of range
  ETCM_FAULT_NO_FEATURE = 4,    // none, out of range or not in use (anymore)
  ETCM_FAULT_ZERO_RANGE = 5,    // ranges are at least 1
  ETCM_FAULT_NO_REGION = 6,     // fewer regions than triangles
  ETCM_FAULT_HAS_FEATURES = 7,  // it must be a mesh of nodes alone
  ETCM_FAULT_IN_CALLBACK = 8,  // a policy, a hook or `nodes_stand` has called what changes the mesh
  ETCM_FAULT_OUTSIDE = 9       // a policy answered no parameter between head and tail
};

// A few words for a person, such as "join" and "no such vertex". Never null.
const char* etcm_call_name(etcm_call_t call);
const char* etcm_fault_name(etcm_fault_t fault);

#ifndef __cplusplus
// The library traps there. A program that wants to log or to reset first defines functions of these
// names, and the linker takes them; they must not return. The first is called for a mistake of the
// program, the second for one of the library, or where its storage was overwritten. Sources in C++
// have them from etcm/illegal_argument.h.
_Noreturn void etcm_illegal_argument(etcm_call_t call, etcm_fault_t fault);
_Noreturn void etcm_check_failed(const char* what, const char* file, int line);
#endif

#ifdef __cplusplus
}
#endif
