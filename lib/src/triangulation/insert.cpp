// A vertex joins the triangulation: split the triangle it lies in, then turn the edges of its link
// that are no longer Delaunay. Walking around the link needs no list of edges, so there is no
// scratch memory to run out of: an insertion cannot fail once its vertex has a place.
#include "triangulation/insert.h"

#include "geometry/predicates_inline.h"
#include "triangulation/change.h"
#include "triangulation/locate.h"
#include "triangulation/mesh_state.h"
#include "triangulation/relative.h"
#include "triangulation/segment_store.h"

namespace etcm::internal {
namespace {

void break_subsegment(Change& change, Edge e) noexcept {
  MeshState& m = change.mesh;
  const VertexId u = m.topology.origin(e), v = m.topology.target(e);
  const SegmentId s = segment_of_edge(m, u, v);
  touch(change, s, u, v);
  make_dirty(change, s);
}

}  // namespace

// Each vertex of the link is looked at once, and each pair of neighbours.
void legalize_link(MeshState& m, Edge e, VertexId last, const Point& p, Change* change) noexcept {
  Topology& topo = m.topology;
  Relative u = relative_to(m, topo.origin(e), p);
  Relative v = relative_to(m, topo.target(e), p);
  double uv = cross_value(u.at, v.at);
  for (;;) {
    const Relative w = relative_to(m, topo.apex(topo.twin(e)), p);
    const double uw = cross_value(u.at, w.at), wv = cross_value(w.at, v.at);
    int side = 0;
    if (u.id != infinite_vertex && v.id != infinite_vertex && w.id != infinite_vertex) {
      // Counter-clockwise: u, w, v.
      side = incircle_coarse(u.height, wv, w.height, -uv, v.height, uw);
    }
    if (side > 0 || (side == 0 && must_flip(m, e, p))) {
      const bool is_kept = topo.is_constrained(e);
      if (is_kept && change != nullptr) break_subsegment(*change, e);
      if (!is_kept || change != nullptr) {
        topo.flip(e);
        v = w;
        uv = uw;
        continue;
      }
    }
    if (v.id == last) {
      m.walk_start = e;
      return;
    }
    e = topo.next_link_edge(e);
    u = v;
    v = relative_to(m, topo.target(e), p);
    uv = cross_value(u.at, v.at);
  }
}

bool conflicts_with_ghost(const MeshState& m, VertexId u, VertexId v, const Point& p) noexcept {
  const int side = orient2d_fast(m.at(u), m.at(v), p);
  return side > 0 || (side == 0 && strictly_between(p, m.at(u), m.at(v)));
}

bool must_flip(const MeshState& m, Edge e, const Point& p) noexcept {
  const Topology& topo = m.topology;
  // Counter-clockwise: a, b, c with b -> c being the twin of e. Of the triangle beyond only the
  // apex is read: an ear has no more (Topology::cut_ear()).
  const VertexId a = topo.apex(topo.twin(e)), b = topo.target(e), c = topo.origin(e);
  if (a == infinite_vertex) return conflicts_with_ghost(m, b, c, p);
  if (b == infinite_vertex) return conflicts_with_ghost(m, c, a, p);
  if (c == infinite_vertex) return conflicts_with_ghost(m, a, b, p);
  const int side = incircle_fast(m.at(a), m.at(b), m.at(c), p);
  if (side != 0) return side > 0;
  return !topo.is_constrained(e) && incircle_perturbed(m.at(a), m.at(b), m.at(c), p) > 0;
}

void insert_vertex(Change& change, VertexId v, const Found& found) noexcept {
  MeshState& m = change.mesh;
  Topology& topo = m.topology;
  if (topo.triangle_count() == 0) {
    if (m.only_vertex.is_none()) {
      m.only_vertex = v;
    } else {
      topo.start(m.only_vertex, v);
      m.only_vertex = VertexId::none();
    }
    return;
  }
  if (found.type == LocateType::outside && !found.vertex.is_none()) {
    // A collinear mesh grows at its end; found.edge runs from there to infinity.
    topo.split_open(found.edge, v);
    m.walk_start = topo.edge_at(v);
    return;
  }
  const Point& p = m.at(v);
  Edge e = topo.split_triangle(Topology::triangle_of(found.edge), v);
  // Where p lies on an edge, the triangle between is flat until that edge flips (p is inside any
  // circle through its ends), so it flips first: in a collinear mesh both its triangles are ghosts
  // that share their other edges too, and must not be met from there.
  for (unsigned side = Topology::side_of(found.edge); side != 0; --side) {
    e = topo.next_link_edge(e);
  }
  legalize_link(m, e, topo.origin(e), p, &change);
}

}  // namespace etcm::internal
