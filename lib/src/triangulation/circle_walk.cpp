// A vertex that is not the nearest to a place has a Delaunay neighbour that is nearer: the place is
// outside of its Voronoi cell, so beyond the bisector with some neighbour. Of vertices that are all
// nearest the sides of their polygon, on a circle that is empty, are edges, and all but the
// lexicographically first have a neighbour there that precedes them. So with ties broken that way
// each vertex but one has a neighbour before it; the first of those is its parent, and the vertices
// are a tree in which the order grows from the root: those within a circle are a part that hangs
// together. As parents can be asked for at any time, the tree is walked depth first with nothing
// remembered but the edge that is looked at (Avis, Fukuda: Reverse search for enumeration, 1996).
#include "triangulation/circle_walk.h"

#include "triangulation/hints.h"
#include "triangulation/locate.h"

namespace etcm::internal {

NearVertex nearest_vertex(const MeshState& m, const Point& place) noexcept {
  const auto seen = [&](VertexId v) noexcept {
    return NearVertex{v, squared_distance(place, m.at(v))};
  };
  if (m.topology.triangle_count() == 0) {
    return m.vertex_count() == 0 ? NearVertex{} : seen(m.only_vertex);
  }
  Pulse pulse(m);
  const Found found = find(m, place, edge_near(m, place));
  pulse.pass(found.steps);
  if (found.type == LocateType::on_vertex) return seen(found.vertex);
  const VertexId origin = m.topology.origin(found.edge);
  NearVertex nearest = seen(origin == infinite_vertex ? m.topology.target(found.edge) : origin);
  for (StepBound bound(m.vertex_count());; bound.step()) {
    const NearVertex before = nearest;
    Spokes spokes(m.topology, before.node);
    do {
      pulse.pass(2);
      if (spokes.target() == infinite_vertex) continue;
      const NearVertex other = seen(spokes.target());
      if (is_nearer(m, other, nearest)) nearest = other;
    } while (spokes.turn());
    if (nearest.node == before.node) return nearest;
  }
}

// Each edge is looked at once from either end.
CircleWalk::CircleWalk(const MeshState& m, const Point& place, const NearVertex& nearest,
                       const SquaredLength& limit) noexcept
    : m_(m),
      place_(place),
      limit_(limit),
      nearest_(nearest),
      bound_(3u * m.topology.triangle_count()),
      pulse_(m) {}

bool CircleWalk::next() noexcept {
  const Topology& topo = m_.topology;
  if (here_.node.is_none()) {
    if (nearest_.node.is_none() || nearest_.distance > limit_) return false;
    here_ = nearest_;
    if (topo.triangle_count() != 0) spoke_ = last_ = topo.edge_at(here_.node);
    return true;
  }
  if (topo.triangle_count() == 0) return false;
  for (;; bound_.step()) {
    pulse_.pass(2);
    const VertexId v = topo.target(spoke_);
    if (v != infinite_vertex) {
      const NearVertex other = seen(v);
      if (is_nearer(m_, other, here_)) {
        // The spoke to the parent is the last one of a vertex.
        if (leads_nearest(spoke_, other)) {
          here_ = other;
          spoke_ = topo.twin(spoke_);
        }
      } else if (other.distance > limit_) {
        if (other.distance < beyond_) beyond_ = other.distance;
      } else if (leads_nearest(topo.twin(spoke_), here_)) {
        here_ = other;
        spoke_ = topo.rotate_ccw(topo.twin(spoke_));
        bound_.step();
        return true;
      }
    }
    spoke_ = topo.rotate_ccw(spoke_);
    if (spoke_ == last_) return false;
  }
}

// A neighbour that is nearer than the target mostly stands beside it, so both sides of it come
// first.
bool CircleWalk::leads_nearest(Edge spoke, const NearVertex& target) noexcept {
  const Topology& topo = m_.topology;
  Edge left = spoke, right = spoke;
  for (StepBound bound(topo.triangle_count());; bound.step()) {
    pulse_.pass(2);
    left = topo.rotate_ccw(left);
    if (left == right) return true;
    if (is_beaten(target, left)) return false;
    right = topo.rotate_cw(right);
    if (left == right) return true;
    if (is_beaten(target, right)) return false;
  }
}

bool CircleWalk::is_beaten(const NearVertex& target, Edge spoke) const noexcept {
  const VertexId v = m_.topology.target(spoke);
  return v != infinite_vertex && is_nearer(m_, seen(v), target);
}

}  // namespace etcm::internal
