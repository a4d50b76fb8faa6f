// Steiner vertices whose cause has gone. Taking a vertex out never breaks another Delaunay edge, so
// this is always safe; and what must be asked is local.
#include "mesh_internal.h"
#include "predicates_inline.h"

namespace etcm::internal {
namespace {

// Whether a - b, the neighbours of the Steiner vertex on its feature, would be a Delaunay edge
// without it: some circle through a and b has none of its link strictly inside. On the left the
// link vertex that sees a - b under the greatest angle gives the circle that leans furthest to the
// right; all of the right must be outside that one. `to_b` and `to_a` leave the Steiner vertex.
bool is_needless(const MeshState& m, Edge to_a, Edge to_b) noexcept {
  const Topology& topo = m.topology;
  const Point& a = m.at(topo.target(to_a));
  const Point& b = m.at(topo.target(to_b));
  VertexId foremost{};
  for (Edge e = topo.rotate_ccw(to_b); e != to_a; e = topo.rotate_ccw(e)) {
    const VertexId v = topo.target(e);
    if (v == infinite_vertex) continue;
    if (foremost.is_none() || incircle_fast(a, b, m.at(foremost), m.at(v)) > 0) foremost = v;
  }
  if (foremost.is_none()) return true;
  for (Edge e = topo.rotate_ccw(to_a); e != to_b; e = topo.rotate_ccw(e)) {
    const VertexId v = topo.target(e);
    if (v != infinite_vertex && incircle_fast(a, b, m.at(foremost), m.at(v)) > 0) return false;
  }
  return true;
}

void make_dirty_around(MeshState& m, VertexId v) noexcept {
  const Edge first = m.topology.edge_at(v);
  Edge e = first;
  do {
    const VertexId w = m.topology.target(e);
    if (w != infinite_vertex && m.owner(w).role() != Role::node) {
      touch(m, m.owner(w).section());
      make_dirty(m, m.owner(w).section());
    }
    e = m.topology.rotate_ccw(e);
  } while (e != first);
}

void prune_section(MeshState& m, SectionId s) noexcept {
  const VertexId end = m.section(s).to;
  VertexId v = m.section(s).from;
  Stretch piece = march(m, v, end);
  while (piece.tail != end) {
    const VertexId steiner = piece.tail;
    const Stretch onward = march(m, steiner, end);
    if (!is_needless(m, m.topology.twin(piece.edge), onward.edge)) {
      m.owner(steiner) = Owner(Role::steiner, s);
      v = steiner;
      piece = onward;
      continue;
    }
    make_dirty_around(m, steiner);
    remove_steiner(m, steiner);
    free_vertex(m, steiner);
    --m.steiner_count;
    piece = march(m, v, end);
    settle_piece(m, piece);
    // The edge is there now, perhaps after turning ties.
    if (!piece.is_edge) piece = march(m, v, end);
  }
}

}  // namespace

void prune(MeshState& m) noexcept {
  for (SectionId s = pop_dirty(m); !s.is_none(); s = pop_dirty(m)) prune_section(m, s);
}

}  // namespace etcm::internal
