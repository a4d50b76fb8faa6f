// Along a straight line from a vertex: rotate around it to the triangle (or edge) that looks the
// right way, then step across edges until a vertex stands on the line. A vertex with many
// neighbours is come to from the other end of the line.
#include "triangulation/march.h"

#include "geometry/predicates_inline.h"
#include "triangulation/mesh_state.h"

namespace etcm::internal {
namespace {

struct Start {
  bool is_edge;
  Edge edge;  // is_edge: along the line; else opposite the head in the triangle the line enters
};

// A Steiner vertex's subsegments lie on its segment, so they need no test of where they point but
// one: forwards or backwards.
bool leave_by_subsegment(const MeshState& m, VertexId head, bool forward, Start& start) noexcept {
  Spokes spokes(m.topology, head);
  do {
    if (m.topology.is_constrained(spokes.edge()) &&
        (m.at(head) < m.at(spokes.target())) == forward) {
      start = {true, spokes.edge()};
      return true;
    }
  } while (spokes.turn());
  return false;
}

// Around most vertices there are fewer edges than this, ...
constexpr std::uint32_t turns_few = 24;
// ... and where there are more, the way back from the other end is mostly shorter than this.
constexpr std::uint32_t steps_back_most = 256;

// Rotates around the head until an edge lies on the line or a triangle spans it: the near end of
// its outer edge on the right, the far one on the left. False: not in so many turns.
bool leave_within(const MeshState& m, VertexId head, const Point& goal, std::uint32_t& turns,
                  Start& start) noexcept {
  const Topology& topo = m.topology;
  const Point& origin = m.at(head);
  const bool forward = origin < goal;
  const auto side_of = [&](VertexId v) {
    return v == infinite_vertex ? 0 : orient2d_fast(origin, goal, m.at(v));
  };
  Edge e = topo.edge_at(head);
  int side = side_of(topo.target(e));
  for (; turns != 0; --turns) {
    const VertexId v = topo.target(e);
    if (side == 0 && v != infinite_vertex && (origin < m.at(v)) == forward) {
      start = {true, e};
      return true;
    }
    const Edge onward = topo.rotate_ccw(e);
    const int next_side = side_of(topo.target(onward));
    if (side < 0 && next_side > 0) {
      start = {false, Topology::next(e)};
      return true;
    }
    e = onward;
    side = next_side;
  }
  return false;
}

// The same by the way along the line from its other end. False: it is too long.
bool leave_backwards(const MeshState& m, VertexId head, VertexId toward, Start& start) noexcept {
  const Topology& topo = m.topology;
  const Point& goal = m.at(head);
  std::uint32_t left = steps_back_most;
  for (VertexId v = toward; leave_within(m, v, goal, left, start);) {
    if (start.is_edge) {
      v = topo.target(start.edge);
      start.edge = topo.twin(start.edge);
      if (v == head) return true;
      continue;
    }
    for (const VertexId from = v; v == from;) {
      if (left == 0) return false;
      --left;
      start.edge = topo.twin(start.edge);
      const VertexId apex = topo.apex(start.edge);
      if (apex == head) return true;
      if (apex == infinite_vertex) return false;
      const int side = orient2d_fast(m.at(from), goal, m.at(apex));
      if (side == 0) v = apex;
      start.edge = side > 0 ? Topology::next(start.edge) : Topology::prev(start.edge);
    }
  }
  return false;
}

Start leave(const MeshState& m, VertexId head, VertexId toward) noexcept {
  Start start{};
  std::uint32_t turns = turns_few;
  if (leave_within(m, head, m.at(toward), turns, start)) return start;
  if (leave_backwards(m, head, toward, start)) return start;
  turns = m.topology.triangle_count();
  if (!leave_within(m, head, m.at(toward), turns, start)) stop_lost_walk();
  return start;
}

}  // namespace

Subsegment march(const MeshState& m, VertexId head, VertexId toward) noexcept {
  const Topology& topo = m.topology;
  const Point& origin = m.at(head);
  const Point& goal = m.at(toward);
  Start start;
  if (m.owner(head).role() == Role::node || !leave_by_subsegment(m, head, origin < goal, start)) {
    start = leave(m, head, toward);
  }
  Subsegment subsegment;
  subsegment.head = head;
  if (start.is_edge) {
    subsegment.is_edge = true;
    subsegment.edge = start.edge;
    subsegment.tail = topo.target(start.edge);
    return subsegment;
  }
  subsegment.head_edge = start.edge;
  // e always runs from the right of the line to its left, and each triangle is crossed once.
  Edge e = start.edge;
  for (StepBound bound(topo.triangle_count());; bound.step()) {
    if (topo.is_constrained(e)) subsegment.constrained = e;
    const Edge beyond = topo.twin(e);
    const VertexId apex = topo.apex(beyond);
    // Beyond the hull there is no vertex to go to.
    if (apex == infinite_vertex) stop_lost_walk();
    const int side = orient2d_fast(origin, goal, m.at(apex));
    if (side == 0) {
      // Always onwards, so that no walk from segment to segment comes back to where it was.
      if ((origin < m.at(apex)) != (origin < goal)) stop_lost_walk();
      subsegment.tail = apex;
      subsegment.tail_edge = beyond;
      return subsegment;
    }
    e = side > 0 ? Topology::next(beyond) : Topology::prev(beyond);
  }
}

Subsegment between(const MeshState& m, VertexId head, VertexId tail) noexcept {
  Subsegment subsegment;
  subsegment.head = head;
  subsegment.tail = tail;
  const Start start = leave(m, head, tail);
  subsegment.is_edge = start.is_edge;
  if (start.is_edge) {
    subsegment.edge = start.edge;
  } else {
    subsegment.head_edge = start.edge;
    subsegment.tail_edge = leave(m, tail, head).edge;
  }
  return subsegment;
}

OwnEdges own_edges(const MeshState& m, VertexId steiner) noexcept {
  Spokes spokes(m.topology, steiner);
  OwnEdges found;
  do {
    const Edge e = spokes.edge();
    if (!m.topology.is_constrained(e)) continue;
    (m.at(spokes.target()) < m.at(steiner) ? found.back : found.onward) = e;
  } while ((found.back.is_none() || found.onward.is_none()) && spokes.turn());
  return found;
}

}  // namespace etcm::internal
