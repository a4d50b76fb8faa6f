// Fewer Steiner vertices, by trials: a few that stand together are taken out, and what is missing
// is laid again in another order, with some splits elsewhere.
#include "conforming/canonical.h"
#include "conforming/trial.h"
#include "triangulation/march.h"
#include "triangulation/mesh_state.h"
#include "triangulation/segment_list.h"
#include "triangulation/segment_store.h"

namespace etcm {
inline namespace ETCM_IDS {

using namespace internal;

namespace {

// A trial is of so many at most.
constexpr unsigned trial_most = 16;
// Of 100 Steiner vertices beside those of a trial, so many join it.
constexpr std::uint32_t joining = 50;

// Numbers that have nothing to do with each other for 0, 1, 2, ... (Steele, Lea and Flood 2014).
std::uint64_t scattered(std::uint64_t number) noexcept {
  std::uint64_t x = (number + 1) * 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  x ^= x >> 31;
  return x != 0 ? x : 1;
}

// A segment's part of sorting them all.
constexpr std::uint32_t work_of_sorting = 16;

// The segments with Steiner vertices in canonical order, linked by next_in_group: which are stale
// is not asked meanwhile.
[[gnu::noinline]] SegmentId list_segments(MeshState& m) noexcept {
  PendingSegments sorted;
  if (!m.work.spend_whole(Units{work_of_sorting} * m.segment_end)) return {};
  for (IdValue i = 0; i < m.segment_end && !m.work.is_over(); ++i) {
    const SegmentId s{i};
    if (is_linked(m, s) &&
        march_counted(m, m.segment(s).from, m.segment(s).to) != m.segment(s).to) {
      sorted.push(m, s);
    }
  }
  sorted.sort(m);
  SegmentId first{};
  SegmentId* end = &first;
  for (SegmentId s = sorted.pop(m); !s.is_none(); s = sorted.pop(m)) {
    *end = s;
    end = &m.segment(s).next_in_group;
  }
  *end = SegmentId::none();
  return first;
}

void unlist_segments(MeshState& m) noexcept {
  for (IdValue i = 0; i < m.segment_end; ++i) m.segment(SegmentId{i}).next_in_group = not_listed;
  m.stale_count = 0;
}

// One of the Steiner vertices of a segment; none: it has none.
[[gnu::noinline]] VertexId draw_vertex(Change& change, SegmentId s) noexcept {
  MeshState& m = change.mesh;
  const VertexId to = m.segment(s).to;
  VertexId drawn{};
  std::uint32_t count = 0;
  for (VertexId v = march_counted(m, m.segment(s).from, to); v != to; v = march_counted(m, v, to)) {
    if (draw(change, ++count) == 0) drawn = v;
  }
  return drawn;
}

// Steiner vertices around the first, nearest in edges first. Spokes are taken from the vertex's own
// segment on, so that it does not matter with which the mesh happens to begin.
// Not inline, like draw_vertex() and list_segments(), or the deepest call would have the room of
// this too.
[[gnu::noinline]] unsigned gather(Change& change, IdValue* vertices) noexcept {
  MeshState& m = change.mesh;
  const unsigned most = 1 + draw(change, trial_most);
  unsigned count = 1;
  for (unsigned i = 0; i < count && count < most; ++i) {
    const OwnEdges own = own_edges(m, VertexId{vertices[i]}, m.work.left());
    if (!m.work.spend(own.looked)) return count;
    const Edge first = own.onward;
    Edge e = first;
    do {
      if (!m.work.spend_whole(1)) return count;
      const VertexId w = m.topology.target(e);
      if (w != infinite_vertex && m.owner(w).role() == Role::steiner &&
          draw(change, 100) < joining) {
        bool is_known = false;
        for (unsigned k = 0; k < count; ++k) is_known = is_known || vertices[k] == w.value;
        if (!is_known) vertices[count++] = w.value;
      }
      e = m.topology.rotate_ccw(e);
    } while (e != first && count < most);
  }
  return count;
}

bool make_trial(MeshState& m, SegmentId s, std::uint32_t number) noexcept {
  Change change(m, Change::Extent::trial);
  change.trial = {.random = scattered(number), .stray = nullptr, .steiner_most = 0};
  IdValue vertices[trial_most];
  const VertexId drawn = draw_vertex(change, s);
  if (drawn.is_none()) return false;
  vertices[0] = drawn.value;
  const unsigned count = gather(change, vertices);
  return !m.work.is_over() && try_without(change, {vertices, count});
}

}  // namespace

Status Mesh::optimise(std::uint32_t trials, std::uint32_t first_trial, Work limit) noexcept {
  MeshState& m = about_to_change(*this, Call::optimise);
  m.error_detail = ErrorDetail{};
  m.work.start(limit, keep_alive_);
  if (m.unresolved != 0) return m.error_detail.status = Status::mesh_unresolved;
  bool is_changed = !is_canonical();
  const SegmentId first = list_segments(m);
  SegmentId s = first;
  std::uint32_t count = 0;
  for (SegmentId i = first; !i.is_none(); i = m.segment(i).next_in_group) ++count;
  for (std::uint32_t i = count != 0 ? first_trial % count : 0; i != 0; --i) {
    s = m.segment(s).next_in_group;
  }
  bool is_over = m.work.is_over();
  for (std::uint32_t i = 0; i < trials && !first.is_none() && !is_over; ++i) {
    if (make_trial(m, s, first_trial + i)) is_changed = true;
    is_over = m.error_detail.status == Status::work_limit || m.work.is_over();
    if (!is_over) m.work.go_on(limit);
    s = m.segment(s).next_in_group;
    if (s.is_none()) s = first;
  }
  unlist_segments(m);
  if (is_changed) {
    m.place_count = 0;
    make_all_stale(m);
  }
  m.error_detail = ErrorDetail{};
  return m.error_detail.status = is_over ? Status::work_limit : Status::ok;
}

}  // namespace ETCM_IDS
}  // namespace etcm
