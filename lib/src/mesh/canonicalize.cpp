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

// Of a vertex, to find its place along the curve.
constexpr std::uint32_t work_of_order = 4;

// Makes the triangulation that of its vertices anew, without marks. Taking the Steiner vertices out
// one by one, or back in, would take longer: along parallels each is a neighbour of all others.
// False: there is no room for the work.
bool triangulate(Change& change) noexcept {
  MeshState& m = change.mesh;
  m.topology.clear();
  m.only_vertex = VertexId::none();
  m.walk_start = Edge{};
  const std::uint32_t count = m.vertex_count();
  if (count == 0) return true;
  if (!m.work.spend_whole(Units{work_of_order} * count)) return false;
  const OrderEntry* const order = hilbert_order(m, Rounds::even);
  for (std::uint32_t i = 0; i < count; ++i) {
    const VertexId v{static_cast<IdValue>(order[i].vertex)};
    const Found found = find(m, m.at(v), m.walk_start, m.work.walk());
    if (!m.work.spend(found.steps) || !insert_vertex(change, v, found)) return false;
  }
  return true;
}

// They keep their places until the change ends.
void detach_steiner(Change& change) noexcept {
  MeshState& m = change.mesh;
  for (IdValue i = 1; i < m.vertex_end; ++i) {
    m.work.pass_entry(i);
    const VertexId v{i};
    if (m.owner(v).role() != Role::steiner) continue;
    m.owner(v) = Owner(Role::detached, m.owner(v).segment());
    m.vertex_edges[i] = Edge{change.detached.value};
    change.detached = v;
  }
  m.steiner_count = 0;
}

void attach_steiner(Change& change) noexcept {
  MeshState& m = change.mesh;
  while (!change.detached.is_none()) {
    const VertexId v = change.detached;
    m.work.pass_entry(v.value);
    change.detached = VertexId{m.vertex_edges[v.value].value};
    m.owner(v) = Owner(Role::steiner, m.owner(v).segment());
    ++m.steiner_count;
  }
}

void free_fresh(MeshState& m) noexcept {
  for (IdValue i = 1; i < m.vertex_end; ++i) {
    m.work.pass_entry(i);
    if (m.owners[i].role() == Role::fresh) free_vertex(m, VertexId{i});
  }
  m.steiner_count = 0;
}

// Lays all segments anew, from the triangulation of the nodes on.
Status lay_all(Change& change) noexcept {
  MeshState& m = change.mesh;
  detach_steiner(change);
  m.knows_dependence = true;
  if (!triangulate(change)) return m.error_detail.status = Status::work_limit;
  PendingSegments pending;
  for (IdValue i = 0; i < m.segment_end; ++i) {
    m.work.pass_entry(i);
    const SegmentId s{i};
    if (!is_linked(m, s)) continue;
    m.segment(s).next_dependent = s;
    pending.push(m, s);
  }
  const Status status = lay_segments(change, pending);
  return status == Status::ok ? lay_lone_again(change) : status;
}

// The same, all or nothing. Some Steiner vertices may have been detached.
Status lay_all_again(Change& change) noexcept {
  MeshState& m = change.mesh;
  if (!m.work.fits(work_to_lay_all(m))) return m.error_detail.status = Status::work_limit;
  m.work.keep(work_to_lay_all(m));
  const Status status = lay_all(change);
  if (status == Status::ok) {
    for (IdValue i = 0; i < m.segment_end; ++i) {
      m.work.pass_entry(i);
      make_canonical(m, SegmentId{i});
    }
    m.is_all_stale = false;
    m.place_count = 0;
    return commit(change);
  }
  m.work.go_back();
  m.error_detail.status = status;
  change.dirty.clear(m);
  free_fresh(m);
  attach_steiner(change);
  static_cast<void>(triangulate(change));
  for (IdValue i = 0; i < m.segment_end; ++i) {
    m.work.pass_entry(i);
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
[[gnu::noinline]] Status find_stale(MeshState& m) noexcept {
  Change change(m);
  const bool is_changed = m.stale_count != 0 || m.place_count != 0;
  if (is_changed && !looks_around_only(m.policy)) make_all_stale(m);
  if (!look_at_places(change)) return m.error_detail.status = Status::work_limit;
  if (m.feature_count == 0) m.is_all_stale = false;
  return Status::ok;
}

// `s` begins the group that had no room for the work.
Status tell_of_group(MeshState& m, SegmentId s, Status status) noexcept {
  if (status == Status::work_limit) m.error_detail.feature = internal::feature_of(m, s);
  return status;
}

Status lay_stale_again(MeshState& m) noexcept {
  for (IdValue i = 0; i < m.segment_end && (m.is_all_stale || m.stale_count != 0); ++i) {
    m.work.pass_entry(i);
    const SegmentId s{i};
    if (!is_linked(m, s) || !is_stale(m, s)) continue;
    Change change(m, m.is_all_stale ? Change::Extent::whole : Change::Extent::group);
    bool is_too_wide = m.is_all_stale;
    const Status status = is_too_wide ? Status::ok : lay_group_again(change, s, is_too_wide);
    if (is_too_wide) return tell_of_group(m, s, lay_all_again(change));
    if (status != Status::ok) return tell_of_group(m, s, status);
    // What has been kept for going back is free again.
    m.work.settle();
  }
  return Status::ok;
}

}  // namespace

Status Mesh::rebuild(Work limit) noexcept {
  MeshState& m = about_to_change(*this, Call::rebuild);
  m.work.start(limit, keep_alive_);
  Change change(m, Change::Extent::whole);
  if (m.unresolved != 0) return m.error_detail.status = Status::mesh_unresolved;
  return is_canonical() ? Status::ok : lay_all_again(change);
}

Status Mesh::canonicalize(Work limit) noexcept {
  MeshState& m = about_to_change(*this, Call::canonicalize);
  m.work.start(limit, keep_alive_);
  m.error_detail = ErrorDetail{};
  if (m.unresolved != 0) return m.error_detail.status = Status::mesh_unresolved;
  const Status status = find_stale(m);
  return status == Status::ok ? lay_stale_again(m) : status;
}

bool Mesh::is_canonical() const noexcept {
  const MeshState& m = opened(*this, Call::is_canonical);
  return m.unresolved == 0 && m.stale_count == 0 && m.place_count == 0 && !m.is_all_stale;
}

}  // namespace ETCM_IDS
}  // namespace etcm
