// Points on one circle: which of their triangulations is the mesh. Features come first, the
// symbolic perturbation settles the rest, separately on each side of a feature.
#include "triangulation/ties.h"

#include "geometry/predicates_inline.h"
#include "triangulation/march.h"
#include "triangulation/mesh_state.h"

namespace etcm::internal {
namespace {

// Each is settled by wide integers, twice.
constexpr Units ties_to_pass = 8;

// An edge that could as well be the other diagonal: both triangles have one circumcircle.
bool is_tie(const MeshState& m, Edge e) noexcept {
  const Topology& topo = m.topology;
  if (topo.is_constrained(e)) return false;
  const VertexId a = topo.apex(e), b = topo.origin(e), c = topo.target(e);
  const VertexId d = topo.apex(topo.twin(e));
  if (a == infinite_vertex || b == infinite_vertex || c == infinite_vertex ||
      d == infinite_vertex) {
    return false;
  }
  return incircle_fast(m.at(a), m.at(b), m.at(c), m.at(d)) == 0;
}

// Brings the patch of triangles around e that share one circumcircle, and that no feature
// separates, to the perturbation's form: goes round its boundary and flips each inner edge it meets
// that is not, until a whole round needed no turn. The boundary keeps its length, and Lawson's
// flips end, so the rounds do. The patch is a triangulated convex polygon: no inner vertex.
void canonicalize_cocircular(MeshState& m, Edge e) noexcept {
  Topology& topo = m.topology;
  if (topo.is_ghost(Topology::triangle_of(e))) return;
  if (!is_tie(m, e) && !is_tie(m, Topology::next(e)) && !is_tie(m, Topology::prev(e))) return;
  unsigned boundary = 0;  // its length, counted in the first round
  unsigned quiet = 0;     // boundary edges since the last turn
  std::uint32_t looked = 0;
  bool first_round = true;
  const auto look = [&]() noexcept {
    ++looked;
    m.work.pass(ties_to_pass);
  };
  VertexId start{};
  for (;;) {
    // On to the next boundary edge, around the vertex at the end of this one.
    e = Topology::next(e);
    for (look(); is_tie(m, e); look()) {
      const Edge beyond = topo.twin(e);
      if (incircle_perturbed(m.at(topo.apex(beyond)), m.at(topo.origin(beyond)),
                             m.at(topo.target(beyond)), m.at(topo.apex(e))) > 0) {
        // e's triangle keeps its apex, and e becomes the edge after the one it was: either
        // boundary or inner, as is asked again.
        topo.flip(e);
        quiet = 0;
      } else {
        e = Topology::next(beyond);
      }
    }
    const VertexId origin = topo.origin(e);
    ++quiet;
    if (start.is_none()) {
      start = origin;
    } else if (first_round && origin == start) {
      first_round = false;
    }
    if (first_round) ++boundary;
    if (!first_round && quiet > boundary) {
      m.work.add_ties(looked);
      return;
    }
  }
}

}  // namespace

Edge flip_in(MeshState& m, const Subsegment& subsegment) noexcept {
  Topology& topo = m.topology;
  const Point& origin = m.at(subsegment.head);
  const Point& goal = m.at(subsegment.tail);
  Edge e = subsegment.head_edge;
  for (std::uint32_t flips = 1;; ++flips) {
    m.work.pass(ties_to_pass);
    const VertexId apex = topo.apex(topo.twin(e));
    const Edge second = topo.flip(e);
    if (apex == subsegment.tail) {
      m.work.add_ties(flips);
      return Topology::prev(second);
    }
    // e now leads from the right to the new corner, `second` from there to the left.
    if (orient2d_fast(origin, goal, m.at(apex)) < 0) e = second;
  }
}

void constrain(MeshState& m, Edge e) noexcept {
  Topology& topo = m.topology;
  topo.mark(e);
  const VertexId u = topo.origin(e), v = topo.target(e);
  canonicalize_cocircular(m, e);
  // Flipping edges may have moved the edge to another triangle.
  if (topo.origin(e) != u || topo.target(e) != v) {
    Spokes spokes(topo, u);
    while (spokes.target() != v) ETCM_CHECK(spokes.turn());
    e = spokes.edge();
    m.work.add_ties(spokes.turns());
  }
  canonicalize_cocircular(m, topo.twin(e));
}

void release_constraint(MeshState& m, Edge e) noexcept {
  m.topology.unmark(e);
  canonicalize_cocircular(m, e);
}

}  // namespace etcm::internal
