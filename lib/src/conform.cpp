// ETCM (paper, Algorithms 2 and 3): makes the sections that miss a piece unions of edges.
//
// A section is walked from its smaller end. What is an edge is marked; what can be one by turning
// ties is turned; a missing piece is split where the policy says, and the walk goes on from the
// same place, so that the remainder is asked again whether it already is an edge. Subsegments that
// a split breaks make their sections dirty, and these come next, in canonical order.
#include "mesh_internal.h"
#include "predicates_inline.h"
#include "reach.h"

namespace etcm::internal {
namespace {

Status fail(MeshState& m, Status status, SectionId s, const Stretch& piece) noexcept {
  m.trouble.status = status;
  m.trouble.feature = feature_of(m, s);
  m.trouble.from = m.at(piece.head);
  m.trouble.to = m.at(piece.tail);
  return status;
}

SplitSite site_of(const MeshState& m, SectionId s, const Stretch& piece) noexcept {
  const Topology& topo = m.topology;
  const SectionRecord& r = m.section(s);
  const auto units = [&](VertexId v) {
    return Position{static_cast<std::int32_t>(m.at(v).x / subunits_per_unit),
                    static_cast<std::int32_t>(m.at(v).y / subunits_per_unit)};
  };
  SplitSite site;
  site.from = units(r.from);
  site.to = units(r.to);
  site.head = piece.head == r.from ? 0 : parameter_of(m, s, piece.head);
  site.tail = piece.tail == r.to ? parameter_end : parameter_of(m, s, piece.tail);
  site.head_right = m.at(topo.origin(piece.head_edge));
  site.head_left = m.at(topo.target(piece.head_edge));
  site.tail_left = m.at(topo.origin(piece.tail_edge));
  site.tail_right = m.at(topo.target(piece.tail_edge));
  site.head_is_node = piece.head == r.from;
  site.tail_is_node = piece.tail == r.to;
  site.reach_head = reach_from_head(site);
  site.reach_tail = reach_from_tail(site);
  site.mesh = m.mesh;
  site.head_triangle = TriangleId{Topology::triangle_of(piece.head_edge)};
  site.tail_triangle = TriangleId{Topology::triangle_of(piece.tail_edge)};
  return site;
}

// Puts a Steiner vertex on the piece.
Status split(MeshState& m, SectionId s, const Stretch& piece, const SplitSite& site, Parameter& t,
             VertexId& v) noexcept {
  if (site.tail - site.head < 2) return fail(m, Status::grid_exhausted, s, piece);
  const std::uint32_t budget = m.config.steiner_max;
  if (budget != 0 && m.steiner_count >= budget) return fail(m, Status::steiner_budget, s, piece);
  v = allocate_vertex(m);
  if (v.is_none()) return fail(m, Status::out_of_vertices, s, piece);
  t = m.config.policy(site);
  if (t <= site.head) t = static_cast<Parameter>(site.head + 1);
  if (t >= site.tail) t = static_cast<Parameter>(site.tail - 1);
  m.points[v.value] = site.at(t);
  m.owner(v) = Owner(Role::fresh, s);
  ++m.steiner_count;
  const bool from_head = t - site.head <= site.tail - t;
  insert_vertex(m, v, find(m, m.at(v), from_head ? piece.head_edge : piece.tail_edge));
  return Status::ok;
}

// Marks the part of a piece between its new vertex and an end that it finishes: nearly always an
// edge by now, else a tie.
void settle_finished(MeshState& m, VertexId v, VertexId end) noexcept {
  Edge e;
  if (m.topology.find_edge(v, end, e)) {
    m.topology.mark(e);
  } else {
    settle_piece(m, between(m, v, end));
  }
}

// Splits a missing piece until it is a run of edges, from both ends inwards. What is left always
// lies between two vertices that are known, so nothing is walked again: no split breaks another
// piece of the same line. Where a policy splits outside both feasible sets it stops, with
// `is_whole` false: the caller looks what is there.
Status conform_piece(MeshState& m, SectionId s, Stretch piece, bool& is_whole) noexcept {
  is_whole = true;
  for (;;) {
    const bool is_last = m.config.steps_max != 0 && m.steps >= m.config.steps_max;
    ++m.steps;
    if (can_be_edge(m, piece)) {
      settle_piece(m, piece);
      return Status::ok;
    }
    // Only where a vertex is needed, so that what gives up has always left a piece that is no edge.
    if (is_last) return fail(m, Status::step_limit, s, piece);
    const SplitSite site = site_of(m, s, piece);
    Parameter t = 0;
    VertexId v{};
    const Status status = split(m, s, piece, site, t, v);
    if (status != Status::ok) return status;
    const bool finishes_head = t <= site.reach_head, finishes_tail = t >= site.reach_tail;
    if (finishes_head) settle_finished(m, v, piece.head);
    if (finishes_tail) settle_finished(m, v, piece.tail);
    if (finishes_head == finishes_tail) {
      is_whole = finishes_head;
      return Status::ok;
    }
    piece = finishes_head ? between(m, v, piece.tail) : between(m, piece.head, v);
  }
}

// Where a node that two features ran through has left, they cross: in a subsegment of the other, or
// exactly in one of its Steiner vertices.
SectionId crossed_section(const MeshState& m, SectionId s, const Stretch& piece) noexcept {
  if (!piece.constrained.is_none()) {
    return section_of_edge(m, m.topology.origin(piece.constrained),
                           m.topology.target(piece.constrained));
  }
  if (piece.tail == m.section(s).to || m.owner(piece.tail).section() == s) return SectionId::none();
  return m.owner(piece.tail).section();
}

Status conform_section(MeshState& m, SectionId s) noexcept {
  SectionRecord& r = m.section(s);
  const VertexId end = r.to;
  VertexId v = r.first.is_none() ? r.from : r.first;
  const VertexId last = r.first.is_none() ? r.to : r.last;
  while (v != last) {
    const Stretch piece = march(m, v, end);
    const SectionId crossed = crossed_section(m, s, piece);
    if (!crossed.is_none()) {
      m.trouble.other = feature_of(m, crossed);
      return fail(m, Status::crossing_features, s, piece);
    }
    if (piece.is_edge) {
      settle_piece(m, piece);
      v = piece.tail;
      continue;
    }
    bool is_whole = false;
    const Status status = conform_piece(m, s, piece, is_whole);
    if (status != Status::ok) return status;
    if (is_whole) v = piece.tail;
  }
  return Status::ok;
}

}  // namespace

bool can_be_edge(const MeshState& m, const Stretch& piece) noexcept {
  if (piece.is_edge) return true;
  // The first triangle's circle is empty. If it goes through the tail, the piece is a chord of it,
  // and all that it crosses ends on that circle too; if not, no empty circle goes through both
  // ends.
  const Edge e = piece.head_edge;
  return incircle_fast(m.at(piece.head), m.at(m.topology.origin(e)), m.at(m.topology.target(e)),
                       m.at(piece.tail)) >= 0;
}

void settle_piece(MeshState& m, const Stretch& piece) noexcept {
  if (piece.is_edge) {
    // It is in the canonical mesh without the mark, so the mark changes nothing.
    m.topology.mark(piece.edge);
  } else {
    constrain(m, flip_in(m, piece));
  }
}

Status conform(MeshState& m) noexcept {
  for (SectionId s = pop_dirty(m); !s.is_none(); s = pop_dirty(m)) {
    const Status status = conform_section(m, s);
    if (status != Status::ok) {
      touch(m, s);
      make_dirty(m, s);
      return status;
    }
  }
  return Status::ok;
}

std::uint32_t settle_rest(MeshState& m) noexcept {
  std::uint32_t missing = 0;
  for (SectionId s = pop_dirty(m); !s.is_none(); s = pop_dirty(m)) {
    const VertexId end = m.section(s).to;
    for (VertexId v = m.section(s).from; v != end;) {
      const Stretch piece = march(m, v, end);
      if (crossed_section(m, s, piece).is_none() && can_be_edge(m, piece)) {
        settle_piece(m, piece);
      } else {
        ++missing;
      }
      v = piece.tail;
    }
  }
  return missing;
}

}  // namespace etcm::internal
