#include "split_harm.h"

#include "predicates_inline.h"
#include "seen.h"

namespace etcm::internal {
namespace {

// A change as wide as this is harm enough.
constexpr unsigned triangles_most = 48;

// Whether p lies strictly inside the circle of the triangle u, v, apex (counter-clockwise). Ties
// break no subsegment.
bool holds(const MeshState& m, const Point& p, const Seen& u, const Seen& v, const Cross& uv,
           VertexId apex) noexcept {
  if (apex == infinite_vertex) return false;
  const Seen w = see(m, apex, p);
  const int side =
      incircle_filter(u.height, cross(v.at, w.at), v.height, cross(w.at, u.at), w.height, uv);
  return (side != 0 ? side : incircle_settle(m.at(u.id), m.at(v.id), m.at(apex), p)) > 0;
}

bool breaks(const MeshState& m, const Point& p, Edge subsegment) noexcept {
  const Topology& topo = m.topology;
  const Seen u = see(m, topo.origin(subsegment), p), v = see(m, topo.target(subsegment), p);
  const Cross uv = cross(u.at, v.at);
  return holds(m, p, u, v, uv, topo.apex(subsegment)) &&
         holds(m, p, v, u, -uv, topo.apex(topo.twin(subsegment)));
}

}  // namespace

unsigned HarmCount::count_known(const Point& p) const noexcept {
  unsigned known = 0;
  for (unsigned i = 0; i < remembered_count_; ++i) known += breaks(m_, p, remembered_[i]);
  return known;
}

void HarmCount::remember(Edge subsegment) noexcept {
  if (remembered_count_ == remembered_most) return;
  const Edge other = m_.topology.twin(subsegment);
  for (unsigned i = 0; i < remembered_count_; ++i) {
    if (remembered_[i] == subsegment || remembered_[i] == other) return;
  }
  remembered_[remembered_count_++] = subsegment;
}

unsigned HarmCount::at(const Point& p, Edge near, unsigned enough) noexcept {
  if (enough <= remembered_count_ && count_known(p) >= enough) return enough;
  const Topology& topo = m_.topology;
  const Found found = find(m_, p, near);
  if (found.place == Place::on_vertex || found.place == Place::outside) return enough;
  // The triangles whose circles hold p hang together like a tree, so none is met twice. What waits
  // are those not yet looked beyond, each by the edge through which it was entered.
  Edge waiting[triangles_most];
  unsigned count = 0;
  unsigned triangles = 1;
  unsigned harm = 0;
  const auto look_beyond = [&](Edge e, const Seen& u, const Seen& v) {
    const Edge beyond = topo.twin(e);
    if (!holds(m_, p, v, u, cross(v.at, u.at), topo.apex(beyond))) return;
    if (topo.is_constrained(e)) {
      ++harm;
      remember(e);
    }
    if (++triangles <= triangles_most) waiting[count++] = beyond;
  };
  look_beyond(found.edge, see(m_, topo.origin(found.edge), p), see(m_, topo.target(found.edge), p));
  waiting[count++] = found.edge;
  while (count != 0 && harm < enough && triangles <= triangles_most) {
    const Edge in = waiting[--count];
    const Seen u = see(m_, topo.origin(in), p), v = see(m_, topo.target(in), p),
               w = see(m_, topo.apex(in), p);
    look_beyond(Topology::next(in), v, w);
    look_beyond(Topology::prev(in), w, u);
  }
  return harm < enough && triangles <= triangles_most ? harm : enough;
}

}  // namespace etcm::internal
