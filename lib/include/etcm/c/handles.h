// Names of nodes and features that never name another one, and dry runs, for C.
#pragma once

#include "etcm/c/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

// --- Handles (etcm/handles.h)
//
// An id names a place, which is used again; a handle is an id and a number that no other has, so
// what is given the handle of something that has gone answers ETCM_STALE_HANDLE. All handles are
// stale where a node or a feature came without the handles knowing: by etcm_join(),
// etcm_add_feature(), etcm_build(), etcm_restore() or etcm_load(), and after etcm_clear().

typedef struct {
  etcm_vertex_t id;
  uint32_t number;  // 0: of none
} etcm_node_handle_t;

typedef struct {
  etcm_feature_t id;
  uint32_t number;
} etcm_feature_handle_t;

// The handles of one mesh; all zero, not open. It is not copied.
typedef struct {
  void* mesh;
  uint32_t* numbers;
  size_t number_count;
  uint32_t given_out;
  uint32_t stale;
} etcm_handles_t;

// How many numbers it keeps: the length of the array that etcm_handles_open() takes.
#define ETCM_HANDLES_WORDS(vertices, features) ((size_t)(vertices) + (features))

// Takes an open mesh and storage, which must outlive it. Handles of an earlier call stay stale
// where `given_out` is what etcm_handles_given_out() came to; 0 at first. Errors:
// ETCM_STORAGE_TOO_SMALL.
ETCM_MUST_USE etcm_status_t etcm_handles_open(etcm_handles_t* handles, etcm_mesh_t* mesh,
                                              uint32_t* numbers, size_t number_count,
                                              uint32_t given_out);
uint32_t etcm_handles_given_out(const etcm_handles_t* handles);

// The id that a handle stands for. Errors: ETCM_STALE_HANDLE. O(1).
ETCM_MUST_USE etcm_status_t etcm_handles_find_node(const etcm_handles_t* handles,
                                                   etcm_node_handle_t node, etcm_vertex_t* id);
ETCM_MUST_USE etcm_status_t etcm_handles_find_feature(const etcm_handles_t* handles,
                                                      etcm_feature_handle_t feature,
                                                      etcm_feature_t* id);
// The handle of what stands. Errors: ETCM_UNKNOWN_VERTEX or ETCM_UNKNOWN_FEATURE, and
// ETCM_OUT_OF_HANDLES. O(1).
ETCM_MUST_USE etcm_status_t etcm_handles_of_node(etcm_handles_t* handles, etcm_vertex_t id,
                                                 etcm_node_handle_t* node);
ETCM_MUST_USE etcm_status_t etcm_handles_of_feature(etcm_handles_t* handles, etcm_feature_t id,
                                                    etcm_feature_handle_t* feature);

// As the changes of the mesh, with their errors; but ETCM_STALE_HANDLE in place of
// ETCM_UNKNOWN_VERTEX and ETCM_UNKNOWN_FEATURE, and besides ETCM_OUT_OF_HANDLES where a handle
// comes out. These two are answered first, and leave etcm_error_detail() and etcm_work_needed() as
// they are.
ETCM_MUST_USE etcm_status_t etcm_handles_join(etcm_handles_t* handles, etcm_position_t position,
                                              uint64_t limit, etcm_node_handle_t* node);
ETCM_MUST_USE etcm_status_t etcm_handles_leave(etcm_handles_t* handles, etcm_node_handle_t node,
                                               uint64_t limit);
ETCM_MUST_USE etcm_status_t etcm_handles_move(etcm_handles_t* handles, etcm_node_handle_t node,
                                              etcm_position_t position, uint64_t limit);
ETCM_MUST_USE etcm_status_t etcm_handles_add_feature(etcm_handles_t* handles,
                                                     etcm_node_handle_t from, etcm_node_handle_t to,
                                                     uint64_t limit,
                                                     etcm_feature_handle_t* feature);
ETCM_MUST_USE etcm_status_t etcm_handles_remove_feature(etcm_handles_t* handles,
                                                        etcm_feature_handle_t feature,
                                                        uint64_t limit);

// --- Dry runs (etcm/dry_run.h)
//
// Whether a change would succeed, and what it would come to: it is made and taken back, which takes
// up to three times as long. The mesh is as it was, etcm_error_detail() and etcm_work_needed()
// included; nobody may read it meanwhile.

typedef struct {
  etcm_status_t status;        // what the change would answer
  etcm_error_detail_t detail;  // what etcm_error_detail() would tell
  int32_t steiner;             // Steiner vertices that would come, less those that would go
  uint64_t work;               // what etcm_work_needed() would tell; made after it, the change may
                               // need a little more: a quarter has always been enough
} etcm_outcome_t;

void etcm_dry_run_join(etcm_mesh_t* mesh, etcm_position_t position, uint64_t limit,
                       etcm_outcome_t* outcome);
void etcm_dry_run_leave(etcm_mesh_t* mesh, etcm_vertex_t node, uint64_t limit,
                        etcm_outcome_t* outcome);
void etcm_dry_run_move(etcm_mesh_t* mesh, etcm_vertex_t node, etcm_position_t position,
                       uint64_t limit, etcm_outcome_t* outcome);
void etcm_dry_run_add_feature(etcm_mesh_t* mesh, etcm_vertex_t from, etcm_vertex_t to,
                              uint64_t limit, etcm_outcome_t* outcome);
void etcm_dry_run_remove_feature(etcm_mesh_t* mesh, etcm_feature_t feature, uint64_t limit,
                                 etcm_outcome_t* outcome);

#ifdef __cplusplus
}
#endif
