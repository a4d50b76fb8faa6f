// ETCM (paper, Algorithms 2 and 3): makes the segments that miss a subsegment unions of edges.
//
// A segment is walked from its smaller end. What is an edge is marked; what can be one by turning
// ties is turned; a missing subsegment is split where the policy says, and the walk goes on from
// the same place, so that the remainder is asked again whether it already is an edge. Subsegments
// that a split breaks make their segments dirty, and these come next, in canonical order.
#include "conforming/conform.h"

#include "base/arguments.h"
#include "conforming/feasible_parameter.h"
#include "conforming/group.h"
#include "geometry/predicates_inline.h"
#include "triangulation/change.h"
#include "triangulation/insert.h"
#include "triangulation/locate.h"
#include "triangulation/march.h"
#include "triangulation/mesh_state.h"
#include "triangulation/segment_store.h"
#include "triangulation/ties.h"

namespace etcm::internal {
namespace {

Status fail(MeshState& m, Status status, SegmentId s, const Subsegment& subsegment) noexcept {
  m.error_detail.status = status;
  m.error_detail.feature = feature_of(m, s);
  m.error_detail.from = m.at(subsegment.head);
  m.error_detail.to = m.at(subsegment.tail);
  return status;
}

// Not inline, or the deepest call would have what it is worked out from on the stack too.
[[gnu::noinline]] SplitSite site_of(const MeshState& m, SegmentId s,
                                    const Subsegment& subsegment) noexcept {
  const Topology& topo = m.topology;
  const SegmentRecord& r = m.segment(s);
  const auto units = [&](VertexId v) noexcept {
    return Position{static_cast<std::int32_t>(m.at(v).x / subunits_per_unit),
                    static_cast<std::int32_t>(m.at(v).y / subunits_per_unit)};
  };
  SplitSite site;
  site.from = units(r.from);
  site.to = units(r.to);
  site.head = subsegment.head == r.from ? 0 : parameter_of(m, s, subsegment.head);
  site.tail = subsegment.tail == r.to ? parameter_end : parameter_of(m, s, subsegment.tail);
  site.head_right = m.at(topo.origin(subsegment.head_edge));
  site.head_left = m.at(topo.target(subsegment.head_edge));
  site.tail_left = m.at(topo.origin(subsegment.tail_edge));
  site.tail_right = m.at(topo.target(subsegment.tail_edge));
  site.head_is_node = subsegment.head == r.from;
  site.tail_is_node = subsegment.tail == r.to;
  site.feasible_head = feasible_from_head(site);
  site.feasible_tail = feasible_from_tail(site);
  site.mesh = m.mesh;
  site.context = m.policy_context;
  site.head_triangle = TriangleId{Topology::triangle_of(subsegment.head_edge)};
  site.tail_triangle = TriangleId{Topology::triangle_of(subsegment.tail_edge)};
  return site;
}

// A split: up to 2 * 29 tests of circles, and marks to set; 62 000 instructions on a Cortex-M0+.
// What the policy asks is counted where it is answered (surroundings.cpp).
constexpr std::uint32_t work_of_split = 64;
// The most that a policy of the library's may look at beyond its limit.
constexpr std::uint32_t work_beyond = 192;

// Inserts a Steiner vertex of the subsegment whose point is set.
// Not inline, or the deepest call, by way of the policy, would have its room too.
[[gnu::noinline]] Status place_vertex(Change& change, SegmentId s, const Subsegment& subsegment,
                                      Edge near, VertexId v) noexcept {
  MeshState& m = change.mesh;
  m.owner(v) = Owner(Role::fresh, s);
  const Found found = find(m, m.at(v), near, m.work.walk());
  // What was found where it stands is looked for again when it goes.
  m.work.keep(work_of_split);
  if (!m.work.spend(found.steps) || m.work.is_over() || !insert_vertex(change, v, found)) {
    free_vertex(m, v);
    return fail(m, Status::work_limit, s, subsegment);
  }
  ++m.steiner_count;
  ++change.fresh_count;
  // The group has grown: what is laid is given up.
  if (change.extent == Change::Extent::group && !stays_in_group(change, v)) {
    return Status::work_limit;
  }
  return Status::ok;
}

// Puts a Steiner vertex on the subsegment, where the policy says.
Status split(Change& change, SegmentId s, const Subsegment& subsegment, const SplitSite& site,
             Parameter& t, VertexId& v) noexcept {
  MeshState& m = change.mesh;
  if (site.tail - site.head < 2) return fail(m, Status::grid_exhausted, s, subsegment);
  const std::uint32_t budget = m.config.steiner_max;
  if (budget != 0 && m.steiner_count >= budget)
    return fail(m, Status::steiner_budget, s, subsegment);
  const bool is_trial = change.extent == Change::Extent::trial;
  if (is_trial && m.steiner_count >= change.trial.steiner_most)
    return fail(m, Status::steiner_budget, s, subsegment);
  v = allocate_vertex(m);
  if (v.is_none()) return fail(m, Status::out_of_vertices, s, subsegment);
  if (m.work.spend_whole(work_of_split) && m.work.fits(work_beyond)) {
    t = m.work.call_out([&]() noexcept { return m.policy(site); });
    demand(site.head < t && t < site.tail, Call::policy, Fault::outside);
    if (is_trial) t = change.trial.stray(change, site, t);
  }
  // What has strayed, or was not asked for because the work is over.
  if (t <= site.head) t = static_cast<Parameter>(site.head + 1);
  if (t >= site.tail) t = static_cast<Parameter>(site.tail - 1);
  m.points[v.value] = site.at(t);
  const bool from_head = t - site.head <= site.tail - t;
  return place_vertex(change, s, subsegment,
                      from_head ? subsegment.head_edge : subsegment.tail_edge, v);
}

// Marks the part of a subsegment between its new vertex and an end that it finishes: nearly always
// an edge by now, else a tie.
void constrain_finished(MeshState& m, VertexId v, VertexId end) noexcept {
  Edge e;
  if (m.topology.find_edge(v, end, e)) {
    m.topology.mark(e);
  } else {
    const Subsegment subsegment = between(m, v, end, m.work.whole_walk());
    m.work.add(subsegment.steps);
    static_cast<void>(constrain_subsegment(m, subsegment));
  }
}

// Splits a missing subsegment until it is a run of edges, from both ends inwards. What is left
// always lies between two vertices that are known, so nothing is walked again: no split breaks
// another subsegment of the same line. Where a policy splits outside both feasible sets it stops,
// with `is_whole` false: the caller looks what is there. `subsegment` is used up.
Status conform_subsegment(Change& change, SegmentId s, Subsegment& subsegment,
                          bool& is_whole) noexcept {
  MeshState& m = change.mesh;
  is_whole = true;
  for (;;) {
    if (m.work.is_over()) return fail(m, Status::work_limit, s, subsegment);
    if (can_be_edge(m, subsegment)) {
      return constrain_subsegment(m, subsegment) ? Status::ok
                                                 : fail(m, Status::work_limit, s, subsegment);
    }
    SplitSite site = site_of(m, s, subsegment);
    site.is_lone = s == change.lone;
    Parameter t = 0;
    VertexId v{};
    const Status status = split(change, s, subsegment, site, t, v);
    if (status != Status::ok) return status;
    const bool finishes_head = t <= site.feasible_head, finishes_tail = t >= site.feasible_tail;
    if (finishes_head) constrain_finished(m, v, subsegment.head);
    if (finishes_tail) constrain_finished(m, v, subsegment.tail);
    if (m.work.is_over()) return fail(m, Status::work_limit, s, subsegment);
    if (finishes_head == finishes_tail) {
      is_whole = finishes_head;
      return Status::ok;
    }
    subsegment = finishes_head ? between(m, v, subsegment.tail, m.work.walk())
                               : between(m, subsegment.head, v, m.work.walk());
    m.work.keep(2 * Units{subsegment.steps});
    static_cast<void>(m.work.spend(subsegment.steps));
  }
}

// Where a node that two features ran through has left, they cross: in a subsegment of the other, or
// exactly in one of its Steiner vertices.
SegmentId crossed_section(const MeshState& m, SegmentId s, const Subsegment& subsegment) noexcept {
  if (!subsegment.constrained.is_none()) {
    return segment_of_edge(m, m.topology.origin(subsegment.constrained),
                           m.topology.target(subsegment.constrained));
  }
  if (subsegment.tail == m.segment(s).to || m.owner(subsegment.tail).segment() == s)
    return SegmentId::none();
  return m.owner(subsegment.tail).segment();
}

Status conform_segment(Change& change, SegmentId s) noexcept {
  MeshState& m = change.mesh;
  const VertexId end = m.segment(s).to;
  auto [v, last] = touched_part(m, s);
  while (v != last) {
    Subsegment subsegment = march(m, v, end, m.work.walk());
    // On the way back it is looked for twice.
    m.work.keep(2 * Units{subsegment.steps});
    if (!m.work.spend(subsegment.steps)) return fail(m, Status::work_limit, s, subsegment);
    const VertexId tail = subsegment.tail;
    const SegmentId crossed = crossed_section(m, s, subsegment);
    if (!crossed.is_none()) {
      m.error_detail.other = feature_of(m, crossed);
      return fail(m, Status::crossing_features, s, subsegment);
    }
    if (subsegment.is_edge) {
      if (!constrain_subsegment(m, subsegment)) return fail(m, Status::work_limit, s, subsegment);
      v = tail;
      continue;
    }
    bool is_whole = false;
    const Status status = conform_subsegment(change, s, subsegment, is_whole);
    if (status != Status::ok) return status;
    if (is_whole) v = tail;
  }
  return Status::ok;
}

}  // namespace

bool can_be_edge(const MeshState& m, const Subsegment& subsegment) noexcept {
  if (subsegment.is_edge) return true;
  // The first triangle's circle is empty. If it goes through the tail, the subsegment is a chord of
  // it, and all that it crosses ends on that circle too; if not, no empty circle goes through both
  // ends.
  const Edge e = subsegment.head_edge;
  return incircle_fast(m.at(subsegment.head), m.at(m.topology.origin(e)),
                       m.at(m.topology.target(e)), m.at(subsegment.tail)) >= 0;
}

bool constrain_subsegment(MeshState& m, const Subsegment& subsegment) noexcept {
  if (!may_constrain(m, subsegment)) return false;
  constrain(m, subsegment);
  return true;
}

Status conform(Change& change) noexcept {
  MeshState& m = change.mesh;
  for (SegmentId s = change.dirty.pop(m); !s.is_none(); s = change.dirty.pop(m)) {
    const Status status = conform_segment(change, s);
    if (status != Status::ok) {
      make_dirty(change, s);
      return status;
    }
  }
  return Status::ok;
}

std::uint32_t constrain_rest(Change& change) noexcept {
  MeshState& m = change.mesh;
  std::uint32_t missing = 0;
  for (SegmentId s = change.dirty.pop(m); !s.is_none(); s = change.dirty.pop(m)) {
    const VertexId end = m.segment(s).to;
    for (VertexId v = m.segment(s).from; v != end;) {
      const Subsegment subsegment = march(m, v, end, m.work.walk());
      if (!m.work.spend(subsegment.steps)) return missing;
      const bool is_free = crossed_section(m, s, subsegment).is_none();
      if (!is_free || !can_be_edge(m, subsegment) || !constrain_subsegment(m, subsegment)) {
        ++missing;
      }
      v = subsegment.tail;
    }
  }
  return missing;
}

}  // namespace etcm::internal
