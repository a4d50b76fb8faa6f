// ETCM for C: exactly conforming Delaunay meshes in memory that the caller gives. C11, also C++11.
//
//   // For 200 nodes and 20 features between them: all the memory there will ever be.
//   enum { vertices = ETCM_VERTICES_FOR(200, 20), segments = ETCM_SEGMENTS_FOR(20) };
//   static ETCM_STORAGE(storage, vertices, segments);
//   static etcm_mesh_t mesh;
//   const etcm_config_t config = {.vertices_max = vertices, .features_max = segments};
//   if (etcm_open(&mesh, storage, sizeof storage, &config) != ETCM_OK) return 1;
//
//   etcm_vertex_t node;
//   const etcm_position_t place = {480, 90};
//   if (etcm_join(&mesh, place, ETCM_UNLIMITED, &node) != ETCM_OK) return 1;
//
// A sensor is a node, a road or a fence a feature: a straight line between two nodes, which the
// mesh makes a union of its edges, exactly, with as few more vertices (Steiner vertices) as it can.
// Vertices are nodes and Steiner vertices together.
//
// - No heap, no threads, no static data, no mathematical library; every call ends.
// - What data can cause is answered with a status (c/types.h), and then the mesh is as it was.
// - What only a mistake in a program can cause stops it: a mesh that is not open, a question of an
//   id that names nothing (a change answers that), storage that is null. It calls
//   etcm_illegal_argument (c/types.h). Other pointers, such as the mesh or where an answer goes,
//   are not checked.
// - One thread changes a mesh, or any number read it: what takes a `const etcm_mesh_t*` writes
//   nothing. A change that is refused, a dry run, etcm_seal() and handles write. Two meshes share
//   nothing: two tasks may change one each at the same time. Handles belong to their mesh.
// - An interrupt may call what a task may: but it must not read a mesh that it may have stopped in
//   the middle of a change, nor change one that it may have stopped being read.
//
// Every call is the one of the same name of the C++ interface. What a program does not call is not
// linked. For relays, coverage, connectivity and readings include etcm/c/analysis.h. What is called
// docs/... is beside these headers in lib, and in /usr/share/doc/libetcm-dev of a package.
#pragma once

#include "etcm/c/bytes.h"      // a mesh that was copied, kept or mapped
#include "etcm/c/handles.h"    // names of nodes and features that outlive them; dry runs
#include "etcm/c/mesh.h"       // the mesh: open, change, read
#include "etcm/c/policy.h"     // where to split: for who wants another rule
#include "etcm/c/questions.h"  // what is at a place, around it, at a node; proofs
#include "etcm/c/types.h"      // ids, coordinates, statuses
#include "etcm/version.h"
