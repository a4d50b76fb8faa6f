// Finding a point by a visibility walk: from triangle to triangle, always across an edge that has
// the point on its other side. In a Delaunay triangulation such a walk never comes back to a
// triangle (the point's power with respect to the circumcircles falls at every step; within a
// cocircular patch the dual is a tree), so it visits each at most once.
#include "triangulation/locate.h"

#include <utility>

#include "etcm/locate.h"
#include "geometry/predicates_inline.h"
#include "triangulation/hints.h"
#include "triangulation/mesh_state.h"

namespace etcm::internal {
namespace {

// The side of triangle t opposite the vertex at infinity, or 3 where t is finite.
unsigned infinite_side(const TriangleRecord& t) noexcept {
  unsigned side = 0;
  while (side < 3 && t.corner[side] != infinite_vertex) ++side;
  return side;
}

// All vertices lie on one line: go along the chain of ghosts on one side of it.
Found find_on_chain(const MeshState& m, const Point& p, Edge near, const Walk& walk) noexcept {
  const Topology& topo = m.topology;
  IdValue t = Topology::triangle_of(near);
  Edge e = Topology::edge(t, infinite_side(topo.triangle(t)));
  const int side = orient2d_fast(m.at(topo.origin(e)), m.at(topo.target(e)), p);
  if (side != 0) return {LocateType::outside, side > 0 ? e : topo.twin(e), {}, 1};
  // Face p: then the chain is followed from origin to target, over the vertex at infinity's star.
  const Point& origin = m.at(topo.origin(e));
  if ((p < origin) != (m.at(topo.target(e)) < origin)) e = topo.twin(e);
  WalkBound bound(walk);
  for (std::uint32_t steps = 1;; ++steps) {
    if (steps > topo.triangle_count() + 1u) stop_lost_walk();
    const VertexId u = topo.origin(e), v = topo.target(e);
    if (p == m.at(u) || bound.is_passed(steps)) return {LocateType::on_vertex, e, u, steps};
    if (p == m.at(v)) return {LocateType::on_vertex, e, v, steps};
    if (strictly_between(p, m.at(u), m.at(v))) return {LocateType::on_edge, e, {}, steps};
    const Edge to_infinity = Topology::next(e);
    const Edge onward = Topology::next(topo.twin(to_infinity));
    // Behind the last vertex comes the other side of the same edge.
    if (onward == topo.twin(e)) return {LocateType::outside, to_infinity, v, steps};
    // twin(to_infinity) runs from infinity to v, so the next edge of its triangle leaves v.
    e = onward;
  }
}

}  // namespace

bool is_flat(const MeshState& m) noexcept {
  if (m.topology.triangle_count() == 0) return false;
  // Behind a hull edge there is a finite triangle, unless there is none at all.
  const IdValue ghost = Topology::triangle_of(m.topology.edge_at(infinite_vertex));
  const unsigned side = infinite_side(m.topology.triangle(ghost));
  const Edge across = m.topology.twin(Topology::edge(ghost, side));
  return m.topology.apex(across) == infinite_vertex;
}

Found find(const MeshState& m, const Point& p, Edge near, Walk walk) noexcept {
  const Topology& topo = m.topology;
  if (topo.triangle_count() == 0) {
    if (!m.only_vertex.is_none() && m.at(m.only_vertex) == p)
      return {LocateType::on_vertex, {}, m.only_vertex, 0};
    return {};
  }
  IdValue t = Topology::triangle_of(near);
  if (t >= topo.triangle_count()) t = static_cast<IdValue>(topo.triangle_count() - 1u);
  unsigned ghost_side = infinite_side(topo.triangle(t));
  if (ghost_side < 3) {
    t = Topology::triangle_of(topo.twin(Topology::edge(t, ghost_side)));
    if (topo.is_ghost(t)) return find_on_chain(m, p, Topology::edge(t, 0), walk);
  }
  // The first triangle is entered nowhere: ask for a third side too, first the one given.
  Edge e = t == Topology::triangle_of(near) ? near : Topology::edge(t, 0);
  VertexId u = topo.origin(e), v = topo.target(e);
  Offset from_u = offset(m.at(u), p), from_v = offset(m.at(v), p);
  const auto side_of = [&](const Offset& a, const Offset& b, VertexId from, VertexId to) noexcept {
    const int side = orient2d_filter(cross(a, b));
    return side != 0 ? side : orient2d_settle(m.at(from), m.at(to), p);
  };
  int s0 = side_of(from_u, from_v, u, v);
  if (s0 < 0) {
    e = topo.twin(e);
    std::swap(u, v);
    std::swap(from_u, from_v);
    s0 = 1;
  }
  const std::uint32_t all = topo.triangle_count() + 1u;
  WalkBound bound(walk, all);
  for (std::uint32_t steps = 1;; ++steps) {
    // p is on the inner side of e = u -> v (s0 > 0) or, in the first triangle only, on its line.
    const VertexId apex = topo.apex(e);
    if (apex == infinite_vertex || bound.is_passed(steps)) {
      if (steps > all) stop_lost_walk();
      return {LocateType::outside, e, {}, steps};
    }
    const Edge e1 = Topology::next(e), e2 = Topology::prev(e);
    const Offset from_apex = offset(m.at(apex), p);
    const int s1 = side_of(from_v, from_apex, v, apex);
    if (s1 < 0) {
      e = topo.twin(e1);
      u = apex;
      from_u = from_apex;
      s0 = 1;
      continue;
    }
    const int s2 = side_of(from_apex, from_u, apex, u);
    if (s2 < 0) {
      e = topo.twin(e2);
      v = apex;
      from_v = from_apex;
      s0 = 1;
      continue;
    }
    const int zeros = (s0 == 0) + (s1 == 0) + (s2 == 0);
    if (zeros == 0) return {LocateType::inside_triangle, e, {}, steps};
    if (zeros == 1) return {LocateType::on_edge, s0 == 0 ? e : s1 == 0 ? e1 : e2, {}, steps};
    // On two sides: their common corner.
    return {LocateType::on_vertex, e, s0 != 0 ? apex : s1 != 0 ? u : v, steps};
  }
}

}  // namespace etcm::internal

namespace etcm {
inline namespace ETCM_IDS {

Location locate(const Mesh& mesh, Point point, TriangleId near) noexcept {
  const internal::MeshState& m = internal::opened(mesh, Call::locate);
  // No vertex stands so far out, and differences would not be exact.
  if (!in_range(point)) return {};
  const internal::Edge start = near.value < m.topology.triangle_count()
                                   ? internal::Topology::edge(near.value, 0)
                                   : internal::edge_near(m, point);
  const internal::Found found = internal::find(m, point, start);
  Location location{.type = found.type, .vertex = found.vertex};
  if (m.topology.triangle_count() == 0) return location;
  if (found.type == LocateType::outside) location.vertex = VertexId::none();
  location.triangle = TriangleId{internal::Topology::triangle_of(found.edge)};
  location.side = static_cast<int>(internal::Topology::side_of(found.edge));
  return location;
}

}  // namespace ETCM_IDS
}  // namespace etcm
