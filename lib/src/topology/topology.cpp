#include "topology/topology.h"

#include "base/check.h"

namespace etcm::internal {

void stop_lost_walk() noexcept {
  fail_check("a walk through the mesh ends", __FILE_NAME__, __LINE__);
}

bool Topology::find_edge(VertexId u, VertexId v, Edge& e) const noexcept {
  Spokes spokes(*this, u);
  do {
    if (spokes.target() == v) {
      e = spokes.edge();
      return true;
    }
  } while (spokes.turn());
  return false;
}

unsigned Topology::degree(VertexId v, std::uint32_t most) const noexcept {
  Spokes spokes(*this, v, most);
  while (spokes.turn()) {
  }
  return spokes.turns();
}

void Topology::start(VertexId a, VertexId b) noexcept {
  triangle_count_ = 2;
  set_corners(0, a, b, infinite_vertex);
  set_corners(1, b, a, infinite_vertex);
  join(edge(0, 0), edge(1, 1).value);
  join(edge(0, 1), edge(1, 0).value);
  join(edge(0, 2), edge(1, 2).value);
  vertex_edges_[a.value] = edge(0, 2);
  vertex_edges_[b.value] = edge(0, 0);
  vertex_edges_[infinite_vertex.value] = edge(0, 1);
}

void Topology::split_open(Edge e, VertexId v) noexcept {
  // e = u -> w and its twin part; (v, u, w) and (v, w, u) go between them.
  const VertexId u = origin(e), w = target(e);
  const IdValue outer = link(e);
  const IdValue s = triangle_count_;
  const IdValue q = static_cast<IdValue>(triangle_count_ + 1u);
  triangle_count_ = static_cast<IdValue>(triangle_count_ + 2u);
  set_corners(s, v, u, w);
  set_corners(q, v, w, u);
  join(edge(s, 0), outer);
  join(edge(q, 0), e.value);
  join(edge(s, 1), edge(q, 2).value);
  join(edge(s, 2), edge(q, 1).value);
  vertex_edges_[v.value] = edge(s, 2);
}

Edge Topology::unsplit_triangle(VertexId v) noexcept {
  // Around v: (v, a, b), (v, b, c), (v, c, a). The first becomes (c, a, b).
  const Edge to_a = edge_at(v);
  const Edge to_b = rotate_ccw(to_a);
  const Edge to_c = rotate_ccw(to_b);
  const VertexId a = target(to_a), b = target(to_b), c = target(to_c);
  const IdValue t = triangle_of(to_a), s = triangle_of(to_b), q = triangle_of(to_c);
  const IdValue outer_bc = link(next(to_b)), outer_ca = link(next(to_c));
  // v's slot takes c: the edge opposite it, a -> b, stays; the two others are joined anew.
  triangles_[t].corner[side_of(next(to_a))] = c;
  join(prev(to_a), outer_bc);  // was b -> v, is b -> c
  join(to_a, outer_ca);        // was v -> a, is c -> a
  vertex_edges_[a.value] = next(to_a);
  vertex_edges_[b.value] = prev(to_a);
  vertex_edges_[c.value] = to_a;
  leave_over(s, q);
  return to_a;
}

void Topology::unsplit_open(VertexId v) noexcept {
  const Edge to_u = edge_at(v);
  const Edge to_w = rotate_ccw(to_u);
  const VertexId u = target(to_u), w = target(to_w);
  const Edge outer_u = twin(next(to_u));  // w -> u, behind u -> w
  const IdValue word = link(next(to_w));  // u -> w, behind w -> u
  join(outer_u, word);
  vertex_edges_[w.value] = outer_u;
  vertex_edges_[u.value] = twin(outer_u);
  leave_over(triangle_of(to_u), triangle_of(to_w));
}

void Topology::leave_over(IdValue s, IdValue q) noexcept {
  left_over_[0] = s > q ? s : q;
  left_over_[1] = s > q ? q : s;
}

void Topology::release_left_over(Edge& follow) noexcept {
  for (const IdValue t : left_over_) release(t, follow);
}

Edge Topology::cut_ear(Edge spoke, Edge below) noexcept {
  const Edge ear = next(twin(spoke));
  flip(spoke);
  mark(ear);
  triangles_[triangle_of(ear)].corner[side_of(prev(ear))] = VertexId{below.value};
  return ear;
}

Edge Topology::open_ear(Edge ear) noexcept {
  VertexId& corner = triangles_[triangle_of(ear)].corner[side_of(prev(ear))];
  const Edge below{corner.value};
  unmark(ear);
  corner = origin(twin(ear));
  return below;
}

void Topology::release(IdValue t, Edge& follow) noexcept {
  triangle_count_ = static_cast<IdValue>(triangle_count_ - 1u);
  const IdValue last = triangle_count_;
  if (t == last) return;
  triangles_[t] = triangles_[last];
  for (unsigned i = 0; i < 3; ++i) {
    const IdValue word = triangles_[t].link[i];
    const Edge other{static_cast<IdValue>(word & static_cast<IdValue>(~constrained_bit))};
    // A triangle of a collinear mesh of two vertices is its own neighbour only through the other
    // one, so `other` never lies in the triangle that moves.
    link(other) = static_cast<IdValue>(edge(t, i).value | (word & constrained_bit));
    // Corner i + 1 is where side i starts.
    Edge& known = vertex_edges_[triangles_[t].corner[i == 2 ? 0 : i + 1].value];
    if (known == edge(last, i)) known = edge(t, i);
  }
  if (triangle_of(follow) == last) follow = edge(t, side_of(follow));
}

}  // namespace etcm::internal
