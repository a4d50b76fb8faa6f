#include "conforming/encroachment_count.h"

#include <cmath>

#include "geometry/predicates_inline.h"
#include "triangulation/locate.h"
#include "triangulation/mesh_state.h"
#include "triangulation/relative.h"
#include "triangulation/segment_store.h"

namespace etcm::internal {
namespace {

// A change as wide as this is harm enough.
constexpr unsigned triangles_most = 48;

// Where at() starts: which subsegments are watched depends on it, and where rounding makes
// at_least() say too much, that could show. So it depends on places alone, not on how the walk came
// or how the triangles are stored.
Edge first_side(const MeshState& m, const Found& found) noexcept {
  const Topology& topo = m.topology;
  const auto precedes = [&](Edge e, Edge other) {
    return m.at(topo.origin(e)) < m.at(topo.origin(other));
  };
  const Edge e = found.edge;
  if (found.place == Place::on_edge) {
    const Edge other = topo.twin(e);
    return !topo.is_ghost(Topology::triangle_of(other)) && precedes(other, e) ? other : e;
  }
  const Edge next = Topology::next(e), prev = Topology::prev(e);
  const Edge first = precedes(next, e) ? next : e;
  return precedes(prev, first) ? prev : first;
}

}  // namespace

// Where the line of the subsegment runs inside the circle of the edge's triangle. False: nowhere.
// In double: it only spares at() work. Worked out from the edge, so that it rounds alike however
// the triangle's corners are stored.
bool EncroachmentCount::chord(Edge edge, Span& span) const noexcept {
  const Topology& topo = line_.mesh.topology;
  const Point& a = line_.mesh.at(topo.origin(edge));
  const Offset b = offset(line_.mesh.at(topo.target(edge)), a);
  const Offset c = offset(line_.mesh.at(topo.apex(edge)), a);
  const Offset head = offset(line_.head, a);
  const double bb = lift(b), cc = lift(c);
  const double half = 0.5 / (b.x * c.y - b.y * c.x);
  const Offset centre{(bb * c.y - cc * b.y) * half, (cc * b.x - bb * c.x) * half};
  const double middle =
      ((centre.x - head.x) * line_.dx + (centre.y - head.y) * line_.dy) * line_.per_squared_length;
  const double power = lift(head) - 2 * (head.x * centre.x + head.y * centre.y);
  const double squared = middle * middle - power * line_.per_squared_length;
  if (!(squared > 0)) return false;
  const double half_length = std::sqrt(squared);
  span = {middle - half_length, middle + half_length};
  return true;
}

void EncroachmentCount::watch(Edge edge) noexcept {
  const Topology& topo = line_.mesh.topology;
  if (!topo.is_constrained(edge) || watched_count_ == watched_most) return;
  const Edge other = topo.twin(edge);
  for (unsigned i = 0; i < watched_count_; ++i) {
    if (watched_[i].edge == edge || watched_[i].edge == other) return;
  }
  Span one, two;
  if (topo.is_ghost(Topology::triangle_of(edge)) || topo.is_ghost(Topology::triangle_of(other)) ||
      !chord(edge, one) || !chord(other, two))
    return;
  watched_[watched_count_++] = {
      edge, {one.from > two.from ? one.from : two.from, one.to < two.to ? one.to : two.to}};
}

unsigned EncroachmentCount::at_least(Parameter t) const noexcept {
  const double place = t - line_.site.head;
  unsigned count = 0;
  for (unsigned i = 0; i < watched_count_; ++i) {
    count += watched_[i].breaks.from < place && place < watched_[i].breaks.to;
  }
  return count;
}

unsigned EncroachmentCount::at(Parameter t, Edge near, unsigned enough) noexcept {
  const Topology& topo = line_.mesh.topology;
  const Point p = line_.site.at(t);
  const Found found = find(line_.mesh, p, near);
  if (found.place == Place::on_vertex || found.place == Place::outside) return enough;
  // The triangles whose circles hold p hang together like a tree: goes round it, its edges u -> v
  // on the left hand, and back through the edge by which a triangle was entered.
  Edge entries[triangles_most];
  unsigned depth = 0;
  unsigned triangles = 1;
  unsigned encroachments = 0;
  Edge e = first_side(line_.mesh, found);
  Relative u = relative_to(line_.mesh, topo.origin(e), p),
           v = relative_to(line_.mesh, topo.target(e), p);
  double uv = cross_value(u.at, v.at);
  for (unsigned sides = 0;;) {
    const Edge beyond = topo.twin(e);
    const VertexId apex = topo.apex(beyond);
    if (apex != infinite_vertex) {
      const Relative w = relative_to(line_.mesh, apex, p);
      const double uw = cross_value(u.at, w.at), wv = cross_value(w.at, v.at);
      // Counter-clockwise: u, w, v. Ties break no subsegment.
      int side = incircle_coarse(u.height, wv, w.height, -uv, v.height, uw);
      if (side == 0)
        side = incircle_fast(line_.mesh.at(u.id), line_.mesh.at(apex), line_.mesh.at(v.id), p);
      if (side > 0) {
        if (topo.is_constrained(e)) {
          ++encroachments;
          watch(e);
        }
        if (encroachments >= enough || ++triangles > triangles_most) return enough;
        entries[depth++] = beyond;
        e = Topology::next(beyond);
        v = w;
        uv = uw;
        continue;
      }
    }
    if (depth == 0 && ++sides == 3) return encroachments;
    e = Topology::next(e);
    while (depth != 0 && e == entries[depth - 1]) {
      e = Topology::next(topo.twin(entries[--depth]));
      if (depth == 0 && ++sides == 3) return encroachments;
    }
    u = v;
    v = relative_to(line_.mesh, topo.target(e), p);
    uv = cross_value(u.at, v.at);
  }
}

}  // namespace etcm::internal
