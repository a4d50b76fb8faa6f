// What a mesh is made of: the head of its storage, and where the arrays behind it lie.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/arguments.h"
#include "base/check.h"
#include "etcm/mesh.h"
#include "topology/segments.h"
#include "topology/topology.h"
#include "triangulation/free_ids.h"
#include "triangulation/work_meter.h"

namespace etcm {
inline namespace ETCM_IDS {
class Handles;
struct Outcome;
}  // namespace ETCM_IDS
}  // namespace etcm

namespace etcm::internal {

// See hints.cpp.
struct HintAxis {
  std::int32_t knot[9] = {};     // in units; about an eighth of the nodes lies between two
  float steps_per_unit[8] = {};  // columns, or rows, between them
};
struct Hints {
  HintAxis x;
  HintAxis y;
  std::int32_t side_bits_most = 0;  // there is room for 2^side_bits_most rows of as many cells, ...
  std::int32_t side_bits = 0;       // ... and so many are used
  std::uint32_t patience = 0;       // nodes that may come before the grid is laid anew
};

inline constexpr unsigned places_most = 16;

inline constexpr std::size_t bytes_per_vertex_triangles = 2 * sizeof(TriangleRecord);

// Capacities and budget, as in MeshConfig.
struct KeptConfig {
  std::uint32_t vertices_max = 0;
  std::uint32_t features_max = 0;
  std::uint32_t steiner_max = 0;
};

// What the bytes are, for who finds them (etcm/storage.h).
struct Seal {
  std::uint64_t magic = 0x6873'656d'6d63'7465;  // "etcmmesh" where the least byte comes first
  std::uint32_t version = 1;                    // of all that lies in the storage
  std::uint32_t id_bits = 8 * sizeof(IdValue);
  std::uint64_t bytes = 0;
  std::uint64_t checksum = 0;  // of the mesh when it was sealed last
};

// The head of the storage is in three parts. Where the arrays behind it are at this time: at the
// front, where it takes the least code to find.
struct MeshArrays {
  Topology topology;
  Point* points = nullptr;            // by vertex
  Owner* owners = nullptr;            // by vertex
  Edge* vertex_edges = nullptr;       // by vertex; detached vertices: their list
  SegmentRecord* segments = nullptr;  // by segment
  VertexId* hint_cells = nullptr;
};
inline constexpr std::size_t arrays_room = 80;
struct PaddedArrays : MeshArrays {
  std::byte room[arrays_room - sizeof(MeshArrays)];
};

// What means the same in every program that has the bytes, wherever they lie: no address, and no
// type that is wider on one machine than on another.
struct KeptState {
  KeptConfig config;
  IdValue vertex_end = 1;  // ids from here on were never used
  IdValue segment_end = 0;
  FreeIds free_vertices;  // below vertex_end
  FreeIds free_segments;  // below segment_end

  std::uint32_t node_count = 0;
  std::uint32_t steiner_count = 0;
  std::uint32_t feature_count = 0;
  std::uint32_t unresolved = 0;
  VertexId only_vertex{};  // the only vertex of a mesh of one, which has no triangle

  Hints hints;

  // What of the mesh is as build() makes it (canonical.h).
  std::uint32_t stale_count = 0;  // segments that are stale
  bool is_all_stale = false;      // all are
  bool knows_dependence = true;   // else what one segment depends on may be any other
  std::uint8_t place_count = 0;   // where vertices have come or gone since it was
  Point places[places_most];

  Edge walk_start{};  // where the last walk ended or the last vertex came; a hint for the next
  ErrorDetail error_detail;  // of the last change
  Seal seal;
};

// What is the program's that has the mesh, and nothing to another one.
struct OwnState {
  SplitPolicy policy = nullptr;
  void* policy_context = nullptr;
  WorkMeter work;              // of the last change
  const Mesh* mesh = nullptr;  // whose this is; for policies
  // Who has handles of all that has come, or would have been asked for them; null: nobody.
  const Handles* handles = nullptr;
  // Where the change that is going on is a dry run: what it comes to. Null: it is made.
  Outcome* outcome = nullptr;
};

// Lives at the head of the caller's storage, the arrays behind it.
struct MeshState : PaddedArrays, KeptState, OwnState {
  const Point& at(VertexId v) const noexcept { return points[v.value]; }
  Owner& owner(VertexId v) noexcept { return owners[v.value]; }
  const Owner& owner(VertexId v) const noexcept { return owners[v.value]; }
  SegmentRecord& segment(SegmentId s) noexcept { return segments[s.value]; }
  const SegmentRecord& segment(SegmentId s) const noexcept { return segments[s.value]; }
  std::uint32_t vertex_count() const noexcept { return node_count + steiner_count; }
  bool is_node(VertexId v) const noexcept {
    return v.value < vertex_end && owner(v).role() == Role::node;
  }
  // A node or a Steiner vertex that is in the mesh.
  bool is_vertex(VertexId v) const noexcept {
    return v != infinite_vertex && v.value < vertex_end && is_in_mesh(owner(v).role());
  }
};

struct MeshAccess {
  // Null: it has not been opened.
  static MeshState* state(const Mesh& mesh) noexcept { return mesh.state_; }
  static void give(Mesh& mesh, MeshState* state) noexcept { mesh.state_ = state; }
  static const KeepAlive& hook(const Mesh& mesh) noexcept { return mesh.keep_alive_; }
};

// For public calls, which ask first.
inline const MeshState& opened(const Mesh& mesh, Call call) noexcept {
  demand(MeshAccess::state(mesh) != nullptr, call, Fault::not_open);
  return *MeshAccess::state(mesh);
}
inline MeshState& opened(Mesh& mesh, Call call) noexcept {
  demand(MeshAccess::state(mesh) != nullptr, call, Fault::not_open);
  return *MeshAccess::state(mesh);
}
inline MeshState& about_to_change(Mesh& mesh, Call call) noexcept {
  MeshState& m = opened(mesh, call);
  demand(!m.work.is_calling_out(), call, Fault::in_callback);
  return m;
}

// Mesh::hash(); as a part of a call that changes the mesh its meter is told how far it has come.
std::uint64_t hash_of(const Mesh& mesh, const MeshState& m, WorkMeter* work) noexcept;

}  // namespace etcm::internal

namespace etcm {
inline namespace ETCM_IDS {
// Of a mesh that is known to be open.
inline const internal::MeshState& state_of(const Mesh& mesh) noexcept {
  return *internal::MeshAccess::state(mesh);
}
inline internal::MeshState& state_of(Mesh& mesh) noexcept {
  return *internal::MeshAccess::state(mesh);
}
}  // namespace ETCM_IDS
}  // namespace etcm
