// A mesh as bytes for C: what was copied, kept over a reset, written to flash or mapped into
// another process is a mesh again (etcm/storage.h, which says what is believed of the bytes).
//
// Storage goes to the program that made it, or to one with the same version of the library, the
// same width of ids and the same order of bytes, on whatever machine. What must outlast an update,
// or goes elsewhere, is saved.
//
// The errors of all calls that attach, and then what was attached before still is: ETCM_NOT_A_MESH,
// ETCM_WRONG_BYTE_ORDER, ETCM_WRONG_VERSION, ETCM_WRONG_ID_WIDTH, ETCM_STORAGE_TOO_SMALL,
// ETCM_DAMAGED; of those that take a policy ETCM_BAD_CONFIG where it has no function. To attach
// bytes that are null or not aligned to 8 is a programming error; what is saved and loaded may lie
// anywhere.
#pragma once

#include "etcm/c/mesh.h"
#include "etcm/c/types.h"

#ifdef __cplusplus
extern "C" {
#endif

// Writes a checksum of the mesh into its storage. Each call that changes the mesh wants a new one,
// also where it was refused, and so does a dry run: after one that is not sealed etcm_attach()
// answers ETCM_DAMAGED, unless it was refused at once. O(n).
void etcm_seal(etcm_mesh_t* mesh);

// Takes storage that holds a sealed mesh, in place of etcm_open(), and keeps the function of
// etcm_keep_alive(). What is in use of the bytes is as it was sealed, but for one time in 2^64; who
// can write the bytes on purpose can make the checksum right. The policy must be the one that the
// mesh had; null: that of the library. Handles are opened anew. O(n).
ETCM_MUST_USE etcm_status_t etcm_attach(etcm_mesh_t* mesh, void* storage, size_t bytes,
                                        const struct etcm_split_policy* policy);
// The same of a copy that this program made of a mesh at rest, sealed or not. O(1).
ETCM_MUST_USE etcm_status_t etcm_attach_copy(etcm_mesh_t* mesh, void* storage, size_t bytes,
                                             const struct etcm_split_policy* policy);

// A mesh in bytes that are not written: all zero, it has none. It must stay where it is.
typedef struct {
  etcm_mesh_t mesh;
  uint64_t head[93];
} etcm_reader_t;

// The bytes must stay as they are while they are read.
ETCM_MUST_USE etcm_status_t etcm_reader_attach(etcm_reader_t* reader, const void* storage,
                                               size_t bytes);
ETCM_MUST_USE etcm_status_t etcm_reader_attach_copy(etcm_reader_t* reader, const void* storage,
                                                    size_t bytes);
// For every call that takes a const etcm_mesh_t*.
const etcm_mesh_t* etcm_reader_mesh(const etcm_reader_t* reader);

// --- Saved meshes

// The bytes that etcm_save() writes: 48, 8 for each vertex id and 16 for each segment; at most
// ETCM_SAVED_BYTES() of the mesh's capacities.
size_t etcm_saved_bytes(const etcm_mesh_t* mesh);
// Writes the mesh compactly, the same bytes on every machine. Every later version of the library
// loads what this one saves; an older one may answer ETCM_WRONG_VERSION. Errors:
// ETCM_BUFFER_TOO_SMALL, ETCM_MESH_UNRESOLVED; then nothing is written. O(n).
ETCM_MUST_USE etcm_status_t etcm_save(const etcm_mesh_t* mesh, void* out, size_t bytes);
// Makes an empty mesh what etcm_save() has written anywhere, in this version of the library or one
// before it, with ids of any width, ids and hash included. Capacities may be others. Believes
// nothing; whatever is wrong leaves the mesh empty. etcm_is_canonical() is not known of it, so the
// next etcm_canonicalize() looks at all of it. Errors: ETCM_MESH_NOT_EMPTY, ETCM_NOT_A_MESH,
// ETCM_WRONG_VERSION, ETCM_DAMAGED, ETCM_OUT_OF_VERTICES, ETCM_OUT_OF_FEATURES,
// ETCM_STEINER_BUDGET, ETCM_WORK_LIMIT. O(n log n).
ETCM_MUST_USE etcm_status_t etcm_load(etcm_mesh_t* mesh, const void* saved, size_t bytes,
                                      uint64_t limit);

#ifdef __cplusplus
}
#endif
