// The features of a standing mesh laid afresh, as build() lays them: all, or those that need it.
#include "conforming/canonical.h"
#include "conforming/conform_features.h"
#include "conforming/group.h"
#include "conforming/lone.h"
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

// Lays all segments anew. Some Steiner vertices may have been detached.
Status lay_all_again(Change& change) noexcept {
  MeshState& m = change.mesh;
  detach_steiner(change);
  triangulate_nodes(change);
  m.knows_dependence = true;
  PendingSegments pending;
  for (IdValue i = 0; i < m.segment_end; ++i) {
    const SegmentId s{i};
    if (!is_linked(m, s)) continue;
    m.segment(s).next_dependent = s;
    pending.push(m, s);
  }
  Status status = lay_segments(change, pending);
  if (status == Status::ok) status = lay_lone_again(change);
  if (status == Status::ok) {
    for (IdValue i = 0; i < m.segment_end; ++i) make_canonical(m, SegmentId{i});
    m.is_all_stale = false;
    m.place_count = 0;
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
  make_all_stale(m);
  return status;
}

// Others may look at more of the mesh than their surroundings.
bool looks_around_only(SplitPolicy policy) noexcept {
  return policy == split_default || policy == split_paper;
}

// What places of changes make stale. Not inline, or the deepest call would have the room of its
// change too.
[[gnu::noinline]] void find_stale(MeshState& m) noexcept {
  Change change(m);
  const bool is_changed = m.stale_count != 0 || m.place_count != 0;
  if (is_changed && !looks_around_only(m.config.policy)) make_all_stale(m);
  look_at_places(change);
  if (m.feature_count == 0) m.is_all_stale = false;
}

Status lay_stale_again(MeshState& m, std::uint32_t steps_max) noexcept {
  std::uint32_t steps = 0;
  for (IdValue i = 0; i < m.segment_end && (m.is_all_stale || m.stale_count != 0); ++i) {
    const SegmentId s{i};
    if (!is_linked(m, s) || !is_stale(m, s)) continue;
    Change change(m, m.is_all_stale ? Change::Extent::whole : Change::Extent::group);
    change.steps = steps;
    change.steps_max = steps_max;
    bool is_too_wide = m.is_all_stale;
    const Status status = is_too_wide ? Status::ok : lay_group_again(change, s, is_too_wide);
    if (is_too_wide) return lay_all_again(change);
    if (status != Status::ok) return status;
    steps = change.steps;
  }
  return Status::ok;
}

}  // namespace

Status Mesh::rebuild() noexcept {
  MeshState& m = opened(*this, Call::rebuild);
  Change change(m, Change::Extent::whole);
  if (m.unresolved != 0) return m.error_detail.status = Status::mesh_unresolved;
  return is_canonical() ? Status::ok : lay_all_again(change);
}

Status Mesh::canonicalize(std::uint32_t steps_max) noexcept {
  MeshState& m = opened(*this, Call::canonicalize);
  m.error_detail = ErrorDetail{};
  if (m.unresolved != 0) return m.error_detail.status = Status::mesh_unresolved;
  find_stale(m);
  return lay_stale_again(m, steps_max);
}

bool Mesh::is_canonical() const noexcept {
  const MeshState& m = opened(*this, Call::is_canonical);
  return m.unresolved == 0 && m.stale_count == 0 && m.place_count == 0 && !m.is_all_stale;
}

}  // namespace ETCM_IDS
}  // namespace etcm
