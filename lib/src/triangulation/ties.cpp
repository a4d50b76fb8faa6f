// Points on one circle: which of their triangulations is the mesh. Features come first, the
// symbolic perturbation settles the rest, separately on each side of a feature.
//
// They are the corners of a convex polygon, and the perturbation raises the greatest most: it is
// above the others, and so is cut off as an ear, then the greatest of those that are left. From a
// fan around the least corner that takes one turn of each: it has one edge inside, to the least.
// And a fan is made by one turn of each edge that does not end there. So it takes as long as there
// are corners, which a walk along their sides tells before.
#include "triangulation/ties.h"

#include "geometry/predicates_inline.h"
#include "triangulation/march.h"
#include "triangulation/mesh_state.h"

namespace etcm::internal {
namespace {

// Each circle is settled by wide integers.
constexpr std::uint32_t work_of_look = 2;
constexpr Units looks_to_pass = 4;

// An edge that could as well be the other diagonal, but for its mark: both triangles have one
// circumcircle.
bool is_on_one_circle(const MeshState& m, Edge e) noexcept {
  const Topology& topo = m.topology;
  const VertexId a = topo.apex(e), b = topo.origin(e), c = topo.target(e);
  const VertexId d = topo.apex(topo.twin(e));
  if (a == infinite_vertex || b == infinite_vertex || c == infinite_vertex ||
      d == infinite_vertex) {
    return false;
  }
  return incircle_fast(m.at(a), m.at(b), m.at(c), m.at(d)) == 0;
}

// Along the sides of the polygon around a triangle: all that lies on its circle, or the part that
// no feature separates from it.
enum class Extent : std::uint8_t { circle, part };
class Sides {
 public:
  Sides(MeshState& m, Edge inside, Extent extent) noexcept : m_(m), extent_(extent), side_(inside) {
    next();
  }
  Edge side() const noexcept { return side_; }
  std::uint32_t looks() const noexcept { return looks_; }
  // On to the next one, around the vertex at the end of this one.
  void next() noexcept {
    side_ = Topology::next(side_);
    while (is_inside(side_)) side_ = Topology::next(m_.topology.twin(side_));
  }

 private:
  bool is_inside(Edge e) noexcept {
    ++looks_;
    m_.work.pass(looks_to_pass);
    if (extent_ == Extent::part && m_.topology.is_constrained(e)) return false;
    return is_on_one_circle(m_, e);
  }

  MeshState& m_;
  Extent extent_;
  Edge side_;
  std::uint32_t looks_ = 0;
};

// How many edges are looked at along all of the circle; more than `most`: it was given up.
std::uint32_t looks_along(MeshState& m, Edge e, std::uint32_t most) noexcept {
  Sides sides(m, e, Extent::circle);
  const Edge first = sides.side();
  do {
    sides.next();
  } while (sides.side() != first && sides.looks() <= most);
  return sides.looks();
}

// Else it has been counted before: may_turn().
void count_back(MeshState& m, Units units) noexcept {
  if (m.work.is_going_back()) m.work.add(units);
}

// Brings the triangles around e that share one circumcircle, and that no feature separates, to the
// perturbation's form.
void canonicalize_cocircular(MeshState& m, Edge e) noexcept {
  Topology& topo = m.topology;
  Sides sides(m, e, Extent::part);
  const Edge first = sides.side();
  Edge least = first;
  std::uint32_t corners = 0;
  do {
    ++corners;
    if (m.at(topo.origin(sides.side())) < m.at(topo.origin(least))) least = sides.side();
    sides.next();
  } while (sides.side() != first);
  Units turns = 0, looks = sides.looks();

  // The fan, counter-clockwise: from here on an edge is opposite the least corner.
  Edge opposite = Topology::next(least), greatest = opposite;
  std::uint32_t before = 0;
  for (std::uint32_t i = 0; i + 2 < corners; ++i) {
    if (i != 0) opposite = topo.next_link_edge(opposite);
    for (;; ++turns) {
      ++looks;
      m.work.pass(looks_to_pass);
      if (topo.is_constrained(opposite) || !is_on_one_circle(m, opposite)) break;
      topo.flip(opposite);
    }
    if (i == 0 || m.at(topo.target(greatest)) < m.at(topo.target(opposite))) {
      greatest = opposite;
      before = i;
    }
  }

  // What is beyond `greatest` is as it shall be. The greatest of the others is one of its ends, and
  // has an ear where it stands beside the least corner.
  std::uint32_t after = corners - 3 - before;
  for (e = greatest;; ++turns) {
    m.work.pass(1);
    if (m.at(topo.origin(e)) < m.at(topo.target(e))) {
      if (after == 0) break;
      --after;
      e = Topology::prev(topo.flip(Topology::next(e)));
    } else {
      if (before == 0) break;
      --before;
      const Edge spoke = Topology::prev(e);
      topo.flip(spoke);
      e = Topology::next(spoke);
    }
  }
  count_back(m, work_of_look * looks + turns);
}

// What it takes to find a chord of the circle again and to bring its two sides to their form, of so
// many looks along all of it: they are looked at once more, each corner twice, and each edge is
// crossed and turns three times.
constexpr Units work_of_turning(Units looks) noexcept {
  return (2 * work_of_look + 2) * looks + 16;
}

bool may_turn(MeshState& m, Edge e) noexcept {
  const std::uint32_t looks = looks_along(m, e, m.work.left() / work_of_look);
  if (!m.work.spend(work_of_look * looks)) return false;
  // Both ways.
  m.work.keep(work_of_turning(looks));
  return m.work.spend_whole(work_of_turning(looks));
}

// Flips the edges that a segment crosses, all of whose ends lie on one empty circle with it, so
// that it becomes an edge; returns it.
Edge flip_in(MeshState& m, const Subsegment& subsegment) noexcept {
  Topology& topo = m.topology;
  const Point& origin = m.at(subsegment.head);
  const Point& goal = m.at(subsegment.tail);
  Edge e = subsegment.head_edge;
  for (std::uint32_t flips = 1;; ++flips) {
    m.work.pass(1);
    const VertexId apex = topo.apex(topo.twin(e));
    const Edge second = topo.flip(e);
    if (apex == subsegment.tail) {
      count_back(m, flips);
      return Topology::prev(second);
    }
    // e now leads from the right to the new corner, `second` from there to the left.
    if (orient2d_fast(origin, goal, m.at(apex)) < 0) e = second;
  }
}

}  // namespace

bool may_constrain(MeshState& m, const Subsegment& subsegment) noexcept {
  if (m.work.is_going_back()) return true;
  if (!subsegment.is_edge) return may_turn(m, subsegment.head_edge);
  // Nothing turns now; but others may turn it while it is not marked, when this is taken back.
  return !m.work.keeps() || may_release(m, subsegment.edge);
}

void constrain(MeshState& m, const Subsegment& subsegment) noexcept {
  if (subsegment.is_edge) {
    // It is in the canonical mesh without the mark, so the mark changes nothing.
    m.topology.mark(subsegment.edge);
    return;
  }
  const Edge e = flip_in(m, subsegment);
  m.topology.mark(e);
  // Its triangle stays while the other side turns.
  const Edge beyond = m.topology.twin(e);
  canonicalize_cocircular(m, e);
  canonicalize_cocircular(m, beyond);
}

bool may_release(MeshState& m, Edge e) noexcept {
  if (m.work.is_going_back()) return true;
  if (!m.work.spend(work_of_look)) return false;
  return !is_on_one_circle(m, e) || may_turn(m, e);
}

void release_constraint(MeshState& m, Edge e) noexcept {
  Topology& topo = m.topology;
  topo.unmark(e);
  // Both sides are in their form, so all is where the edge between them is.
  if (!is_on_one_circle(m, e)) return;
  const Edge beyond = topo.twin(e);
  if (incircle_perturbed(m.at(topo.apex(beyond)), m.at(topo.origin(beyond)),
                         m.at(topo.target(beyond)), m.at(topo.apex(e))) > 0) {
    canonicalize_cocircular(m, e);
  }
}

}  // namespace etcm::internal
