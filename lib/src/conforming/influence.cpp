// Circles and lines are compared in double, and what is near enough to be in doubt counts as
// touching: too much influence costs time, too little a wrong mesh.
#include "conforming/influence.h"

#include "geometry/root.h"
#include "triangulation/hints.h"
#include "triangulation/insert.h"
#include "triangulation/locate.h"
#include "triangulation/mesh_state.h"
#include "triangulation/relative.h"
#include "triangulation/segment_store.h"

namespace etcm::internal {
namespace {

// What touches within this part of a circle's size is in doubt, ...
constexpr double doubt = 1e-8;
// ... and with no angle of a greater sine all of a triangle is: its circle is not known well
// enough.
constexpr double least_sine = 1e-5;
// Wider influence than this many triangles is not followed.
constexpr unsigned triangles_most = 64;
constexpr unsigned waiting_most = 16;
constexpr unsigned seen_most = 40;
constexpr unsigned hole_most = 64;

// Where doubles are computed in software, so long it takes to work out a circle, to go on through a
// triangle, with two comparisons of edges and a circle, to look at one with the circles of two
// others, and to find the next edge of a hole: 9 000, 14 000, 29 000 and 3 000 instructions on a
// Cortex-M0+.
constexpr Units work_of_circle = 9;
constexpr Units work_to_follow = 14;
constexpr Units work_of_two_circles = 28;
constexpr Units work_of_side = 3;

// The circle of a triangle. Seen from one of its corners, so that differences are exact.
struct Circle {
  Point origin;
  Offset centre{};
  double squared_radius = 0;
  bool is_in_doubt = false;
};

// Sets the circle, as it is seen from a corner, and answers whether it is known well enough. Not
// inline, for it is asked for three times.
[[gnu::noinline]] bool see_circle(Circle& circle, const Point& corner, const Point& second,
                                  const Point& third) noexcept {
  circle.origin = corner;
  const Offset b = offset(second, corner);
  const Offset c = offset(third, corner);
  const double doubled_area = rounded_cross(b, c);
  circle.is_in_doubt =
      !(doubled_area * doubled_area > least_sine * least_sine * rounded_lift(b) * rounded_lift(c));
  if (circle.is_in_doubt) return false;
  circle.centre = circle_centre(b, c, 0.5 / doubled_area);
  circle.squared_radius = rounded_lift(circle.centre);
  return true;
}

// A needle is flat at one of its corners alone, and its circle is a small one.
Circle circle_through(const Point& first, const Point& second, const Point& third) noexcept {
  Circle circle;
  static_cast<void>(see_circle(circle, first, second, third) ||
                    see_circle(circle, second, third, first) ||
                    see_circle(circle, third, first, second));
  return circle;
}

Circle circle_of(const MeshState& m, IdValue triangle) noexcept {
  const TriangleRecord& t = m.topology.triangle(triangle);
  return circle_through(m.at(t.corner[0]), m.at(t.corner[1]), m.at(t.corner[2]));
}

bool has_on_it(const MeshState& m, const Circle& circle, VertexId v) noexcept {
  if (circle.is_in_doubt) return true;
  const Offset at = offset(m.at(v), circle.origin);
  const Offset from{at.x - circle.centre.x, at.y - circle.centre.y};
  return rounded_lift(from) <= circle.squared_radius * (1 + doubt);
}

// Whether the circle comes inside of an edge, which has no end inside of the circle. One that only
// meets an end of it does not.
bool touches(const MeshState& m, const Circle& circle, Edge e) noexcept {
  if (circle.is_in_doubt) return true;
  const Offset a = offset(m.at(m.topology.origin(e)), circle.origin);
  const Offset b = offset(m.at(m.topology.target(e)), circle.origin);
  const Offset along{b.x - a.x, b.y - a.y};
  const Offset from{a.x - circle.centre.x, a.y - circle.centre.y};
  const double squared_length = rounded_lift(along);
  const double nearest = -rounded_dot(from, along);
  if (nearest < -doubt * squared_length || nearest > (1 + doubt) * squared_length) return false;
  const double aside = rounded_cross(from, along);
  return aside * aside <= circle.squared_radius * squared_length * (1 + doubt);
}

void tell(Change& change, SegmentId s, SegmentId about, OnSegment found) noexcept {
  if (s != about && !s.is_none()) found(change, s, about);
}

void tell_owner(Change& change, VertexId v, SegmentId about, OnSegment found) noexcept {
  const Owner owner = change.mesh.owner(v);
  if (v != infinite_vertex && owner.role() != Role::node)
    tell(change, owner.segment(), about, found);
}

// The subsegments that a circle empty of vertices touches, on e and beyond it. They cut the circle
// like chords, so no triangle is met twice.
bool follow(Change& change, const Circle& circle, Edge first, SegmentId about,
            OnSegment found) noexcept {
  const MeshState& m = change.mesh;
  const Topology& topo = m.topology;
  IdValue waiting[waiting_most];
  waiting[0] = first.value;
  unsigned count = 1;
  if (!change.mesh.work.spend_whole(work_of_circle)) return false;
  for (unsigned triangles = 0; count != 0; ++triangles) {
    if (triangles == triangles_most || !change.mesh.work.spend_whole(work_to_follow)) return false;
    const Edge e{waiting[--count]};
    if (topo.is_constrained(e)) {
      tell(change, segment_of_edge(m, topo.origin(e), topo.target(e)), about, found);
    }
    const Edge beyond = topo.twin(e);
    const VertexId apex = topo.apex(beyond);
    if (apex == infinite_vertex) continue;
    if (m.owner(apex).role() != Role::node && has_on_it(m, circle, apex)) {
      tell_owner(change, apex, about, found);
    }
    for (const Edge onward : {Topology::next(beyond), Topology::prev(beyond)}) {
      if (!touches(m, circle, onward)) continue;
      if (count == waiting_most) return false;
      waiting[count++] = onward.value;
    }
  }
  return true;
}

// Around an edge of the hole that a vertex at the place would make.
bool look_beyond(Change& change, const Point& place, Edge e, OnSegment found) noexcept {
  const MeshState& m = change.mesh;
  const VertexId u = m.topology.origin(e), v = m.topology.target(e);
  tell_owner(change, u, SegmentId::none(), found);
  if (u == infinite_vertex || v == infinite_vertex) return true;
  return follow(change, circle_through(place, m.at(u), m.at(v)), e, SegmentId::none(), found);
}

// The triangles on the left of e whose circles touch it: those of their corners that are Steiner
// vertices. On the way straight from where a circle touches e to its triangle, every triangle's
// circle touches e.
bool look_left(Change& change, Edge e, SegmentId about, OnSegment found) noexcept {
  const MeshState& m = change.mesh;
  const Topology& topo = m.topology;
  IdValue seen[seen_most];
  seen[0] = Topology::triangle_of(e);
  if (topo.is_ghost(seen[0])) return true;
  unsigned count = 1;
  for (unsigned i = 0; i < count; ++i) {
    if (!change.mesh.work.spend_whole(work_of_two_circles)) return false;
    for (unsigned side = 0; side < 3; ++side) {
      const Edge f = Topology::edge(seen[i], side);
      tell_owner(change, topo.apex(f), about, found);
      if (f == e) continue;
      const IdValue next = Topology::triangle_of(topo.twin(f));
      if (topo.is_ghost(next)) continue;
      bool is_seen = false;
      for (unsigned k = 0; k < count && !is_seen; ++k) is_seen = seen[k] == next;
      if (is_seen || !touches(m, circle_of(m, next), e)) continue;
      if (count == seen_most) return false;
      seen[count++] = next;
    }
  }
  return true;
}

}  // namespace

bool find_influenced(Change& change, VertexId v, SegmentId about, OnSegment found) noexcept {
  const MeshState& m = change.mesh;
  const Topology& topo = m.topology;
  if (topo.triangle_count() == 0) return true;
  Spokes spokes(topo, v);
  do {
    const Edge e = spokes.edge();
    const IdValue t = Topology::triangle_of(e);
    tell_owner(change, topo.target(e), about, found);
    // Beyond the hull there is no line.
    if (topo.is_ghost(t)) continue;
    if (!follow(change, circle_of(m, t), Topology::next(e), about, found)) return false;
  } while (spokes.turn());
  return true;
}

// The triangles whose circles hold the place hang together like a tree: goes round it, its edges on
// the left hand, and back through the edge by which a triangle was entered.
bool find_influenced(Change& change, const Point& place, OnSegment found) noexcept {
  const MeshState& m = change.mesh;
  const Topology& topo = m.topology;
  if (topo.triangle_count() == 0) return true;
  const Found at = find(m, place, edge_near(m, place), change.mesh.work.walk());
  if (!change.mesh.work.spend(at.steps)) return false;
  if (at.type == LocateType::on_vertex)
    return find_influenced(change, at.vertex, SegmentId::none(), found);
  if (is_flat(m)) return false;
  IdValue entries[hole_most];
  unsigned depth = 0;
  Edge e = at.edge;
  for (unsigned edges = 0; edges != 4 * hole_most; ++edges) {
    if (!change.mesh.work.spend_whole(work_of_side)) return false;
    if (must_flip(m, e, place)) {
      if (topo.is_constrained(e)) {
        tell(change, segment_of_edge(m, topo.origin(e), topo.target(e)), SegmentId::none(), found);
      }
      if (depth == hole_most) return false;
      entries[depth++] = topo.twin(e).value;
      e = Topology::next(topo.twin(e));
      continue;
    }
    if (!look_beyond(change, place, e, found)) return false;
    e = Topology::next(e);
    while (depth != 0 && e.value == entries[depth - 1]) {
      e = Topology::next(topo.twin(Edge{entries[--depth]}));
    }
    if (depth == 0 && e == at.edge) return true;
  }
  return false;
}

bool find_influenced(Change& change, Edge e, SegmentId about, OnSegment found) noexcept {
  const MeshState& m = change.mesh;
  for (const Edge side : {e, m.topology.twin(e)}) {
    const IdValue t = Topology::triangle_of(side);
    if (m.topology.is_ghost(t)) continue;
    const Circle circle = circle_of(m, t);
    if (!follow(change, circle, Topology::next(side), about, found) ||
        !follow(change, circle, Topology::prev(side), about, found))
      return false;
  }
  return true;
}

bool find_influencing(Change& change, Edge e, SegmentId about, OnSegment found) noexcept {
  return look_left(change, e, about, found) &&
         look_left(change, change.mesh.topology.twin(e), about, found);
}

}  // namespace etcm::internal
