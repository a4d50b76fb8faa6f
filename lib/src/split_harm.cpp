#include "split_harm.h"

#include "predicates_inline.h"

namespace etcm::internal {
namespace {

// Whether p lies strictly inside the circle of e's triangle. Ties break no subsegment.
bool holds(const MeshState& m, Edge e, const Point& p) noexcept {
  const TriangleRecord& t = m.topology.triangle(Topology::triangle_of(e));
  const VertexId a = t.corner[0], b = t.corner[1], c = t.corner[2];
  if (a == infinite_vertex || b == infinite_vertex || c == infinite_vertex) return false;
  return incircle_fast(m.at(a), m.at(b), m.at(c), p) > 0;
}

}  // namespace

unsigned count_harm(const MeshState& m, const Point& p, Edge near, unsigned enough) noexcept {
  const Topology& topo = m.topology;
  const Found found = find(m, p, near);
  if (found.place == Place::on_vertex || found.place == Place::outside) return enough;
  // The triangles whose circles hold p hang together like a tree, so none is met twice, and what
  // waits are the edges that lead out of those already met.
  constexpr unsigned triangles_most = 64;
  Edge waiting[triangles_most + 3];
  unsigned triangles = 1;
  unsigned count = 0;
  for (unsigned side = 0; side < 3; ++side) {
    waiting[count++] = Topology::edge(Topology::triangle_of(found.edge), side);
  }
  unsigned harm = 0;
  while (count != 0 && harm < enough) {
    const Edge out = waiting[--count];
    const Edge in = topo.twin(out);
    if (!holds(m, in, p)) continue;
    harm += topo.is_constrained(out);
    // A change as wide as this is harm enough. It is the number of triangles that decides, not how
    // many wait: that would depend on the order in which they are met.
    if (++triangles > triangles_most) return enough;
    waiting[count++] = Topology::next(in);
    waiting[count++] = Topology::prev(in);
  }
  return harm;
}

}  // namespace etcm::internal
