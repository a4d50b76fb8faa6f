// What a mesh is made of: the head of its storage, and where the arrays behind it lie.
#pragma once

#include <cstddef>
#include <span>

#include "base/arguments.h"
#include "base/check.h"
#include "etcm/mesh.h"
#include "topology/segments.h"
#include "topology/topology.h"
#include "triangulation/work_meter.h"

namespace etcm::internal {

// See hints.cpp.
struct HintAxis {
  std::int32_t knot[9] = {};     // in units; about an eighth of the nodes lies between two
  float steps_per_unit[8] = {};  // columns, or rows, between them
};
struct Hints {
  VertexId* nodes = nullptr;  // by cell
  HintAxis x;
  HintAxis y;
  int side_bits_most = 0;      // there is room for 2^side_bits_most rows of as many cells, ...
  int side_bits = 0;           // ... and so many are used
  std::uint32_t patience = 0;  // nodes that may come before the grid is laid anew
};

inline constexpr unsigned places_most = 16;

inline constexpr std::size_t bytes_per_vertex_triangles = 2 * sizeof(TriangleRecord);

// Lives at the head of the caller's storage, the arrays behind it.
struct MeshState {
  MeshConfig config;
  Topology topology;
  Point* points = nullptr;            // by vertex
  Owner* owners = nullptr;            // by vertex
  Edge* vertex_edges = nullptr;       // by vertex; free and detached vertices: their list
  SegmentRecord* segments = nullptr;  // by segment
  std::byte* triangle_memory = nullptr;

  IdValue vertex_end = 1;  // ids from here on were never used
  IdValue segment_end = 0;
  VertexId free_vertices{};
  SegmentId free_segments{};
  std::uint32_t free_segment_count = 0;

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
  ErrorDetail error_detail;    // of the last change
  WorkMeter work;              // of the last change
  const Mesh* mesh = nullptr;  // whose this is; for policies

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
