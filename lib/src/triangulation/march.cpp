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
  std::uint32_t steps;  // that it took; more than were allowed: it was given up
};

// A Steiner vertex's subsegments lie on its segment, so they need no test of where they point but
// one: forwards or backwards.
bool leave_by_subsegment(const MeshState& m, VertexId head, bool forward, std::uint32_t steps_most,
                         Start& start) noexcept {
  const bool is_few = steps_most < any_steps / marks_a_step;
  Spokes spokes(m.topology, head, is_few ? marks_a_step * steps_most : any_steps);
  bool found = false;
  do {
    found =
        m.topology.is_constrained(spokes.edge()) && (m.at(head) < m.at(spokes.target())) == forward;
  } while (!found && spokes.turn());
  start = {found, spokes.edge(), (spokes.turns() + marks_a_step - 1) / marks_a_step};
  return found;
}

// Rotates around the head, from `e` on, until an edge lies on the line or a triangle spans it: the
// near end of its outer edge on the right, the far one on the left. False: not in so many turns,
// and `e` is the edge to go on from.
bool leave_within(const MeshState& m, VertexId head, const Point& goal, std::uint32_t& turns,
                  Edge& e, Start& start) noexcept {
  const Topology& topo = m.topology;
  const Point& origin = m.at(head);
  const bool forward = origin < goal;
  const auto side_of = [&](VertexId v) noexcept {
    return v == infinite_vertex ? 0 : orient2d_fast(origin, goal, m.at(v));
  };
  int side = side_of(topo.target(e));
  for (; turns != 0; --turns) {
    const VertexId v = topo.target(e);
    if (side == 0 && v != infinite_vertex && (origin < m.at(v)) == forward) {
      start.is_edge = true;
      start.edge = e;
      return true;
    }
    const Edge onward = topo.rotate_ccw(e);
    const int next_side = side_of(topo.target(onward));
    if (side < 0 && next_side > 0) {
      start.is_edge = false;
      start.edge = Topology::next(e);
      return true;
    }
    e = onward;
    side = next_side;
  }
  return false;
}

// The same all around, and the meter is told now and then.
bool leave_somewhere(const MeshState& m, VertexId head, const Point& goal, std::uint32_t& left,
                     WorkMeter* meter, Start& start) noexcept {
  constexpr std::uint32_t most = WalkBound::steps_between;
  Edge e = m.topology.edge_at(head);
  while (left != 0) {
    const std::uint32_t allowed = left < most ? left : most;
    std::uint32_t turns = allowed;
    const bool found = leave_within(m, head, goal, turns, e, start);
    left -= allowed - turns;
    if (found) return true;
    if (meter != nullptr) meter->pass(2 * Units{allowed});
  }
  return false;
}

// The same by the way along the line from its other end. False: it is too long.
bool leave_backwards(const MeshState& m, VertexId head, VertexId toward, std::uint32_t& left,
                     WorkMeter* meter, Start& start) noexcept {
  const Topology& topo = m.topology;
  const Point& goal = m.at(head);
  for (VertexId v = toward; leave_somewhere(m, v, goal, left, meter, start);) {
    if (start.is_edge) {
      v = topo.target(start.edge);
      start.edge = topo.twin(start.edge);
      if (v == head) return true;
      continue;
    }
    for (const VertexId from = v; v == from;) {
      if (left == 0) return false;
      if (--left % WalkBound::steps_between == 0 && meter != nullptr) {
        meter->pass(WalkBound::units_between);
      }
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

// Where the first few turns have not found it. Some steps have been taken before.
// Not inline: it is rare.
[[gnu::noinline]] Start leave_afar(const MeshState& m, VertexId head, VertexId toward,
                                   const Walk& walk, std::uint32_t steps) noexcept {
  Start start{};
  const auto most = [&](std::uint32_t wanted) noexcept {
    const std::uint32_t left = steps < walk.steps_most ? walk.steps_most - steps : 0;
    return wanted < left ? wanted : left;
  };
  std::uint32_t allowed = most(steps_back_most), left = allowed;
  bool found = leave_backwards(m, head, toward, left, walk.meter, start);
  if (!found) {
    steps += allowed - left;
    const std::uint32_t all = m.topology.triangle_count();
    allowed = left = most(all);
    found = leave_somewhere(m, head, m.at(toward), left, walk.meter, start);
    if (!found && allowed == all) stop_lost_walk();
  }
  start.steps = found ? steps + (allowed - left) + 1 : walk.steps_most + 1;
  if (!found) start = {true, m.topology.edge_at(head), start.steps};
  return start;
}

Start leave(const MeshState& m, VertexId head, VertexId toward, const Walk& walk,
            std::uint32_t steps) noexcept {
  const std::uint32_t all = steps < walk.steps_most ? walk.steps_most - steps : 0;
  const std::uint32_t allowed = all < turns_few ? all : turns_few;
  std::uint32_t left = allowed;
  Start start{};
  Edge e = m.topology.edge_at(head);
  if (!leave_within(m, head, m.at(toward), left, e, start)) {
    return leave_afar(m, head, toward, walk, steps + allowed);
  }
  start.steps = steps + (allowed - left) + 1;
  return start;
}

}  // namespace

Subsegment march(const MeshState& m, VertexId head, VertexId toward, Walk walk) noexcept {
  const Topology& topo = m.topology;
  const Point& origin = m.at(head);
  const Point& goal = m.at(toward);
  Start start{};
  if (m.owner(head).role() == Role::node ||
      !leave_by_subsegment(m, head, origin < goal, walk.steps_most, start)) {
    start = leave(m, head, toward, walk, start.steps);
  }
  Subsegment subsegment;
  subsegment.head = head;
  subsegment.steps = start.steps;
  if (start.is_edge) {
    subsegment.is_edge = true;
    subsegment.edge = start.edge;
    subsegment.tail = topo.target(start.edge);
    return subsegment;
  }
  subsegment.head_edge = start.edge;
  // e always runs from the right of the line to its left, and each triangle is crossed once.
  Edge e = start.edge;
  WalkBound allowed(walk);
  for (StepBound bound(topo.triangle_count());; bound.step()) {
    if (topo.is_constrained(e)) subsegment.constrained = e;
    const Edge beyond = topo.twin(e);
    const VertexId apex = topo.apex(beyond);
    // Beyond the hull there is no vertex to go to.
    if (apex == infinite_vertex) stop_lost_walk();
    const int side = orient2d_fast(origin, goal, m.at(apex));
    if (side == 0 || allowed.is_passed(++subsegment.steps)) {
      // Always onwards, so that no walk from segment to segment comes back to where it was.
      if (side == 0 && (origin < m.at(apex)) != (origin < goal)) stop_lost_walk();
      subsegment.tail = apex;
      subsegment.tail_edge = beyond;
      return subsegment;
    }
    e = side > 0 ? Topology::next(beyond) : Topology::prev(beyond);
  }
}

VertexId march_counted(MeshState& m, VertexId head, VertexId toward) noexcept {
  const Subsegment subsegment = march(m, head, toward, m.work.walk());
  return m.work.spend(subsegment.steps) ? subsegment.tail : toward;
}

Subsegment between(const MeshState& m, VertexId head, VertexId tail, Walk walk) noexcept {
  Subsegment subsegment;
  subsegment.head = head;
  subsegment.tail = tail;
  const Start start = leave(m, head, tail, walk, 0);
  subsegment.steps = start.steps;
  subsegment.is_edge = start.is_edge;
  if (start.is_edge) {
    subsegment.edge = start.edge;
  } else {
    subsegment.head_edge = start.edge;
    const Start end = leave(m, tail, head, walk, start.steps);
    subsegment.tail_edge = end.edge;
    subsegment.steps = end.steps;
  }
  return subsegment;
}

OwnEdges own_edges(const MeshState& m, VertexId steiner, std::uint32_t turns_most) noexcept {
  Spokes spokes(m.topology, steiner, turns_most);
  OwnEdges found;
  do {
    const Edge e = spokes.edge();
    if (!m.topology.is_constrained(e)) continue;
    (m.at(spokes.target()) < m.at(steiner) ? found.back : found.onward) = e;
  } while ((found.back.is_none() || found.onward.is_none()) && spokes.turn());
  found.looked = spokes.turns();
  return found;
}

}  // namespace etcm::internal
