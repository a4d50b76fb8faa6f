// A vertex leaves the triangulation: its star is cut down ear by ear until three triangles are
// left, which become one.
//
// An ear a, b, c of the link is cut (the edge to b flips into the edge a - c) when its circumcircle
// is empty of the rest of the link: then it is a triangle of the new mesh. Devillers (On deletion
// in Delaunay triangulations, 1999) picks ears by the power of the vertex and needs no such test,
// but comparing two powers exactly takes integers of 320 bits.
//
// A tie counts only across the new edge a - c: the link's own edges stay whatever happens, so a
// point beyond one of them, on the circle, is not seen from the ear (features win ties, and what
// they decided outside the star is not undone here).
//
// That takes the square of the degree and more, so all of a large link but a few are cut off
// before, at random, whatever their circles hold, and come back in the reverse order: as Chew
// builds the Delaunay triangulation of a convex polygon (Building Voronoi diagrams for convex
// polygons in linear expected time, 1990). Without b the vertex would have the rest of its star, so
// what is there is the Delaunay triangulation of those that stand, and each comes back between two
// that stand, where the edges that it can see flip as in any insertion. None of the hole's sides is
// one of them: the triangles beyond are those of the mesh without the vertex. Expected O(degree).
#include "triangulation/remove.h"

#include "geometry/predicates_inline.h"
#include "triangulation/insert.h"
#include "triangulation/mesh_state.h"
#include "triangulation/ties.h"

namespace etcm::internal {
namespace {

// The ear at the end b of `spoke` (from the leaving vertex): a and c are b's neighbours in the
// link.
bool is_ear(const MeshState& m, Edge spoke) noexcept {
  const Topology& topo = m.topology;
  const Edge after = topo.rotate_ccw(spoke);
  const Edge before = topo.rotate_cw(spoke);
  const VertexId a = topo.target(before), b = topo.target(spoke), c = topo.target(after);
  if (a == c) return false;
  const bool ghost = a == infinite_vertex || b == infinite_vertex || c == infinite_vertex;
  // A ghost ear lies behind the edge u -> v; all the link must be on the other side of it.
  const VertexId u = a == infinite_vertex ? b : b == infinite_vertex ? c : a;
  const VertexId v = a == infinite_vertex ? c : b == infinite_vertex ? a : b;
  if (!ghost && orient2d_fast(m.at(a), m.at(b), m.at(c)) <= 0) return false;
  for (Edge e = topo.rotate_ccw(after); e != before; e = topo.rotate_ccw(e)) {
    const VertexId q = topo.target(e);
    if (q == infinite_vertex) continue;
    const Point& p = m.at(q);
    if (ghost) {
      if (q != u && q != v && conflicts_with_ghost(m, u, v, p)) return false;
      continue;
    }
    const int side = incircle_fast(m.at(a), m.at(b), m.at(c), p);
    if (side > 0) return false;
    if (side == 0 && orient2d_fast(m.at(c), m.at(a), p) < 0 &&
        incircle_perturbed(m.at(a), m.at(b), m.at(c), p) > 0) {
      return false;
    }
  }
  return true;
}

// Where each test of a circle is settled by wide integers.
constexpr std::uint32_t tests_to_pass = 8;
// To put one back: itself, and what it turns.
constexpr std::uint32_t work_of_ear = 32;
// So many the tests of ears are quicker for.
constexpr unsigned few = 8;
// In each round about half of those that are left; in the last all.
constexpr unsigned rounds_most = 16;

bool is_drawn(VertexId b, unsigned round) noexcept {
  std::uint32_t hash = (b.value + 1u) * 2654435761u;
  hash = (hash ^ (hash >> 15)) * 2246822519u;
  return (((hash ^ (hash >> 13)) >> round) & 1u) != 0 || round >= rounds_most;
}

// Whether v is inside of the link without the end of the spoke too. Of more than four one can
// always be cut: of the angles between every second neighbour the mean is below a half turn.
bool can_be_cut(const MeshState& m, VertexId v, Edge spoke) noexcept {
  const Topology& topo = m.topology;
  const VertexId a = topo.target(topo.rotate_cw(spoke)), c = topo.apex(spoke);
  if (topo.target(spoke) == infinite_vertex) return false;
  return a == infinite_vertex || c == infinite_vertex ||
         orient2d_fast(m.at(v), m.at(a), m.at(c)) > 0;
}

// Cuts the star down to a few; returns the ear that was cut last.
Edge cut_star(MeshState& m, VertexId v, unsigned& degree) noexcept {
  Topology& topo = m.topology;
  Edge last{};
  Edge spoke = topo.edge_at(v);
  for (unsigned round = 0; degree > few; ++round) {
    for (unsigned left = degree; left != 0 && degree > few; --left) {
      m.work.pass(1);
      const Edge onward = topo.rotate_ccw(spoke);
      if (is_drawn(topo.target(spoke), round) && can_be_cut(m, v, spoke)) {
        last = topo.cut_ear(spoke, last);
        --degree;
      }
      spoke = onward;
    }
  }
  return last;
}

}  // namespace

void remove_vertex(MeshState& m, VertexId v, unsigned degree) noexcept {
  Topology& topo = m.topology;
  if (topo.triangle_count() == 0) {
    m.only_vertex = VertexId::none();
    return;
  }
  if (topo.triangle_count() == 2) {
    const VertexId other = topo.target(topo.edge_at(v));
    m.only_vertex =
        other == infinite_vertex ? topo.target(topo.rotate_ccw(topo.edge_at(v))) : other;
    topo.clear();
    return;
  }
  if (degree == 2) {
    topo.unsplit_open(v);
    topo.release_left_over(m.walk_start);
    m.walk_start = Edge{0};
    return;
  }
  Edge cut = cut_star(m, v, degree);
  Edge spoke = topo.edge_at(v);
  for (unsigned tried = 0; degree > 3;) {
    ETCM_CHECK(tried <= degree);
    m.work.pass(tests_to_pass * Units{degree});
    const Edge onward = topo.rotate_ccw(spoke);
    if (is_ear(m, spoke)) {
      // The spoke's triangle keeps its slot for the corner after the ear; v goes on with the next.
      const VertexId next = topo.target(onward);
      topo.flip(spoke);
      --degree;
      tried = 0;
      spoke = topo.edge_at(v);
      while (topo.target(spoke) != next) spoke = topo.rotate_ccw(spoke);
    } else {
      spoke = onward;
      ++tried;
    }
  }
  m.walk_start = topo.unsplit_triangle(v);
  while (!cut.is_none()) {
    const Edge e = cut;
    m.work.pass(work_of_ear);
    cut = topo.open_ear(e);
    static_cast<void>(legalize_link(m, e, topo.target(e), m.at(topo.apex(e)), nullptr));
  }
  topo.release_left_over(m.walk_start);
}

void remove_steiner(MeshState& m, VertexId v) noexcept {
  // Its subsegments go first: as long as they hold ties on their circles, the triangles there are
  // not those of the vertices alone, and more of them than the star would have to change.
  const Topology& topo = m.topology;
  unsigned degree = 1;
  for (Edge e = topo.edge_at(v), last = topo.rotate_cw(e);; ++degree) {
    if (topo.is_constrained(e)) {
      release_constraint(m, e);
      e = topo.edge_at(v);
      last = topo.rotate_cw(e);
      degree = 1;
    }
    if (e == last) break;
    e = topo.rotate_ccw(e);
  }
  remove_vertex(m, v, degree);
}

}  // namespace etcm::internal
