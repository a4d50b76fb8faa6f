// The features of a standing mesh laid afresh, as build() lays them.
#include "conforming/conform_features.h"
#include "conforming/transaction.h"
#include "triangulation/change.h"
#include "triangulation/hilbert_order.h"
#include "triangulation/insert.h"
#include "triangulation/locate.h"
#include "triangulation/mesh_state.h"
#include "triangulation/segment_store.h"

namespace etcm {
inline namespace ETCM_IDS {

using namespace internal;

namespace {

// Makes the triangulation that of the nodes alone. Taking the Steiner vertices out one by one would
// take longer than to begin anew: along parallels each is a neighbour of all others.
void triangulate_nodes(Change& change) noexcept {
  MeshState& m = change.mesh;
  m.topology.clear();
  m.only_vertex = VertexId::none();
  m.walk_start = Edge{};
  if (m.node_count == 0) return;
  const OrderEntry* const order = hilbert_order(m);
  for (std::uint32_t i = 0; i < m.node_count; ++i) {
    const VertexId v{static_cast<IdValue>(order[i].vertex)};
    insert_vertex(change, v, find(m, m.at(v), m.walk_start));
  }
}

// They keep their places until the change ends.
void detach_steiner(Change& change) noexcept {
  MeshState& m = change.mesh;
  for (IdValue i = 1; i < m.vertex_end; ++i) {
    const VertexId v{i};
    if (m.owner(v).role() != Role::steiner) continue;
    m.owner(v) = Owner(Role::detached, m.owner(v).segment());
    m.vertex_edges[i] = Edge{change.detached.value};
    change.detached = v;
  }
  m.steiner_count = 0;
}

void free_fresh(MeshState& m) noexcept {
  for (IdValue i = 1; i < m.vertex_end; ++i) {
    if (m.owners[i].role() == Role::fresh) free_vertex(m, VertexId{i});
  }
  m.steiner_count = 0;
}

}  // namespace

Status Mesh::rebuild() noexcept {
  MeshState& m = opened(*this, Call::rebuild);
  Change change(m, Change::Extent::whole);
  if (m.unresolved != 0) return m.error_detail.status = Status::mesh_unresolved;
  detach_steiner(change);
  triangulate_nodes(change);
  PendingSegments pending;
  for (IdValue i = 0; i < m.segment_end; ++i) {
    if (is_linked(m, SegmentId{i})) pending.push(m, SegmentId{i});
  }
  const Status status = lay_segments(change, pending);
  if (status == Status::ok) {
    commit(change);
    return status;
  }
  change.dirty.clear(m);
  free_fresh(m);
  triangulate_nodes(change);
  for (IdValue i = 0; i < m.segment_end; ++i) {
    if (is_linked(m, SegmentId{i})) touch(change, SegmentId{i});
  }
  restore_detached(change);
  return status;
}

}  // namespace ETCM_IDS
}  // namespace etcm
