#include "etcm/surroundings.h"

#include <cmath>

#include "geometry/predicates_inline.h"
#include "geometry/root.h"
#include "triangulation/locate.h"
#include "triangulation/mesh_state.h"
#include "triangulation/relative.h"
#include "triangulation/segment_store.h"

namespace etcm {
inline namespace ETCM_IDS {

using namespace internal;

namespace {

// A change as wide as this is harm enough.
constexpr unsigned triangles_most = 48;

// Where doubles are computed in software: a vertex beside the subsegment, with what a policy works
// out of it; a place, with what leads to it and where its walk ends; a triangle of that walk. 5
// 000, 38 000 and 12 000 instructions on a Cortex-M0+.
constexpr Units work_of_vertex = 5;
constexpr Units work_of_place = 40;
constexpr Units work_of_triangle = 12;

// Sides of triangles, two bits each: this stands at the deepest place of a change.
class SidePath {
 public:
  void set(unsigned place, unsigned side) noexcept {
    std::uint32_t& word = words_[place / 16];
    const unsigned shift = 2 * (place % 16);
    word = (word & ~(3u << shift)) | (side << shift);
  }
  unsigned at(unsigned place) const noexcept {
    return (words_[place / 16] >> (2 * (place % 16))) & 3u;
  }

 private:
  std::uint32_t words_[(triangles_most + 15) / 16] = {};
};

// Where at() starts: which subsegments are watched depends on it, and where rounding makes
// at_least() say too much, that could show. So it depends on places alone, not on how the walk came
// or how the triangles are stored.
Edge first_side(const MeshState& m, const Found& found) noexcept {
  const Topology& topo = m.topology;
  const auto precedes = [&](Edge e, Edge other) noexcept {
    return m.at(topo.origin(e)) < m.at(topo.origin(other));
  };
  const Edge e = found.edge;
  if (found.type == LocateType::on_edge) {
    const Edge other = topo.twin(e);
    return !topo.is_ghost(Topology::triangle_of(other)) && precedes(other, e) ? other : e;
  }
  const Edge next = Topology::next(e), prev = Topology::prev(e);
  const Edge first = precedes(next, e) ? next : e;
  return precedes(prev, first) ? prev : first;
}

// The policy runs within a change of the mesh, so nobody else reads it.
WorkMeter& work_of(const SplitSite& site) noexcept { return MeshAccess::state(*site.mesh)->work; }

}  // namespace

// Few edges are subsegments, so this is asked before anything is called.
inline void Surroundings::watch(EdgeWord edge) noexcept {
  if (mesh_.topology.is_constrained(Edge{edge})) watch_subsegment(edge);
}

Surroundings::Surroundings(const SplitSite& site) noexcept
    : site_(site),
      mesh_(state_of(*site.mesh)),
      head_(site.at(site.head)),
      dx_(static_cast<double>(site.to.x) - site.from.x),
      dy_(static_cast<double>(site.to.y) - site.from.y),
      // Exact but for the division: the differences have 25 bits.
      per_squared_length_(1.0 / (dx_ * dx_ + dy_ * dy_)),
      head_edge_(edge_before(site.head_triangle, head_)),
      tail_edge_(edge_before(site.tail_triangle, site.at(site.tail))) {}

// Opposite the end of the subsegment in its triangle.
Surroundings::EdgeWord Surroundings::edge_before(TriangleId triangle,
                                                 const Point& end) const noexcept {
  Edge e = Topology::edge(triangle.value, 0);
  while (mesh_.at(mesh_.topology.apex(e)) != end) e = Topology::next(e);
  return e.value;
}

VertexId Surroundings::shared_node(End end) const noexcept {
  const bool at_head = end == End::head;
  const VertexId v = mesh_.topology.apex(Edge{at_head ? head_edge_ : tail_edge_});
  const SegmentRecord& segment = mesh_.segment(mesh_.owner(v).segment());
  const bool is_node = at_head ? site_.head_is_node : site_.tail_is_node;
  const VertexId node = is_node ? v : at_head ? segment.from : segment.to;
  const SegmentId first = mesh_.owner(node).segment();
  return next_at(mesh_, first, node).is_none() ? VertexId::none() : node;
}

bool Surroundings::is_on_segment_from(VertexId node, VertexId vertex) const noexcept {
  const Owner owner = mesh_.owner(vertex);
  for (SegmentId s = owner.segment(); !s.is_none(); s = next_at(mesh_, s, vertex)) {
    if (owner.role() == Role::node && !work_of(site_).spend_whole(1)) return false;
    const SegmentRecord& r = mesh_.segment(s);
    if (r.from == node || r.to == node) return true;
    if (owner.role() != Role::node) return false;
  }
  return false;
}

void Surroundings::start(End end) noexcept {
  end_ = end;
  told_ = 0;
  stop_ = Edge{}.value;
  if (end == End::head) {
    edge_ = head_edge_;
  } else if (edge_ != Edge{}.value) {
    // Where head's walk stands, or nothing is left.
    stop_ = mesh_.topology.twin(Edge{edge_}).value;
    edge_ = tail_edge_;
  }
}

bool Surroundings::next(Beside& out) noexcept {
  const Edge e{edge_};
  if (e.is_none() || !work_of(site_).spend_whole(work_of_vertex)) return false;
  const Topology& topo = mesh_.topology;
  if (told_ < 2) {
    see(told_ == 0 ? topo.target(e) : topo.origin(e), out);
    if (++told_ == 2) {
      watch(Topology::next(e).value);
      watch(Topology::prev(e).value);
    }
    return true;
  }
  if (edge_ == stop_) return false;
  const Edge beyond = topo.twin(e);
  const VertexId v = topo.apex(beyond);
  see(v, out);
  int side = orient2d_filter(cross({dx_, dy_}, offset(mesh_.at(v), head_)));
  if (side == 0) side = orient2d_settle(to_point(site_.from), to_point(site_.to), mesh_.at(v));
  const Edge after = Topology::next(beyond), before = Topology::prev(beyond);
  if (side == 0) {
    watch(after.value);
    watch(before.value);
    edge_ = Edge{}.value;
    return false;
  }
  // From head the left comes at the end of an edge, from tail at its start.
  const bool onward = (side > 0) == (end_ == End::head);
  edge_ = (onward ? after : before).value;
  watch((onward ? before : after).value);
  return true;
}

void Surroundings::see(VertexId v, Beside& out) const noexcept {
  const Offset at = offset(mesh_.at(v), head_);
  out.vertex = v;
  out.is_node = mesh_.owner(v).role() == Role::node;
  out.point = mesh_.at(v);
  out.along = product(rounded_dot(at, {dx_, dy_}), per_squared_length_);
  out.aside = product(std::fabs(rounded_cross({dx_, dy_}, at)), per_squared_length_);
}

// Where the line of the subsegment runs inside the circle of the edge's triangle. False: nowhere.
// In double: it only spares at() work. Worked out from the edge, so that it rounds alike however
// the triangle's corners are stored.
bool Surroundings::chord(EdgeWord word, Span& span) const noexcept {
  const Edge edge{word};
  const Topology& topo = mesh_.topology;
  const Point& a = mesh_.at(topo.origin(edge));
  const Offset b = offset(mesh_.at(topo.target(edge)), a);
  const Offset c = offset(mesh_.at(topo.apex(edge)), a);
  const Offset head = offset(head_, a);
  const Offset centre = circle_centre(b, c, 0.5 / rounded_cross(b, c));
  const double middle =
      product(rounded_dot({centre.x - head.x, centre.y - head.y}, {dx_, dy_}), per_squared_length_);
  const double power = rounded_lift(head) - 2 * rounded_dot(head, centre);
  const double squared = product(middle, middle) - product(power, per_squared_length_);
  if (!(squared > 0)) return false;
  const double half_length = root_of(squared);
  span = {middle - half_length, middle + half_length};
  return true;
}

void Surroundings::watch_subsegment(EdgeWord word) noexcept {
  const Edge edge{word};
  const Topology& topo = mesh_.topology;
  if (watched_count_ == watched_most) return;
  const Edge other = topo.twin(edge);
  for (unsigned i = 0; i < watched_count_; ++i) {
    if (watched_[i].edge == edge.value || watched_[i].edge == other.value) return;
  }
  Span one, two;
  if (topo.is_ghost(Topology::triangle_of(edge)) || topo.is_ghost(Topology::triangle_of(other)) ||
      !chord(edge.value, one) || !chord(other.value, two))
    return;
  const Span both{one.from > two.from ? one.from : two.from, one.to < two.to ? one.to : two.to};
  // What the subsegment itself does not come to takes no place from what it does.
  if (both.from < both.to && both.to > 0 && both.from < site_.tail - site_.head)
    watched_[watched_count_++] = {edge.value, both};
}

unsigned Surroundings::encroachments_at_least(Parameter t) const noexcept {
  const double place = t - site_.head;
  unsigned count = 0;
  for (unsigned i = 0; i < watched_count_; ++i) {
    count += watched_[i].breaks.from < place && place < watched_[i].breaks.to;
  }
  return count;
}

unsigned Surroundings::encroachments(Parameter t, unsigned enough) noexcept {
  const bool near_head = t - site_.head <= site_.tail - t;
  const Edge near{near_head ? head_edge_ : tail_edge_};
  const Topology& topo = mesh_.topology;
  const Point p = site_.at(t);
  WorkMeter& work = work_of(site_);
  if (!work.spend_whole(work_of_place)) return enough;
  const Found found = find(mesh_, p, near, work.walk());
  if (!work.spend(found.steps)) return enough;
  if (found.type == LocateType::on_vertex || found.type == LocateType::outside) return enough;
  // The triangles whose circles hold p hang together like a tree: goes round it, its edges u -> v
  // on the left hand, and back through the edge by which a triangle was entered. Of the triangles
  // on the way back that edge's side is enough: the edge before it leads to the triangle.
  SidePath sides_of_entries;
  Edge entry{};
  unsigned depth = 0;
  unsigned triangles = 1;
  unsigned encroachments = 0;
  Edge e = first_side(mesh_, found);
  Relative u = relative_to(mesh_, topo.origin(e), p), v = relative_to(mesh_, topo.target(e), p);
  double uv = cross_value(u.at, v.at);
  for (unsigned sides = 0;;) {
    const Edge beyond = topo.twin(e);
    const VertexId apex = topo.apex(beyond);
    if (apex != infinite_vertex) {
      const Relative w = relative_to(mesh_, apex, p);
      const double uw = cross_value(u.at, w.at), wv = cross_value(w.at, v.at);
      // Counter-clockwise: u, w, v. Ties break no subsegment.
      int side = incircle_coarse(u.height, wv, w.height, -uv, v.height, uw);
      if (side == 0) side = incircle_fast(mesh_.at(u.id), mesh_.at(apex), mesh_.at(v.id), p);
      if (side > 0) {
        if (topo.is_constrained(e)) {
          ++encroachments;
          watch_subsegment(e.value);
        }
        if (encroachments >= enough || ++triangles > triangles_most ||
            !work.spend_whole(work_of_triangle)) {
          return enough;
        }
        sides_of_entries.set(depth++, Topology::side_of(entry));
        entry = beyond;
        e = Topology::next(beyond);
        v = w;
        uv = uw;
        continue;
      }
    }
    // It has taken as long as one that leads on.
    work.pass(work_of_triangle);
    if (depth == 0 && ++sides == 3) return encroachments;
    e = Topology::next(e);
    while (depth != 0 && e == entry) {
      const Edge back = topo.twin(entry);
      entry = Topology::edge(Topology::triangle_of(back), sides_of_entries.at(--depth));
      e = Topology::next(back);
      if (depth == 0 && ++sides == 3) return encroachments;
    }
    u = v;
    v = relative_to(mesh_, topo.target(e), p);
    uv = cross_value(u.at, v.at);
  }
}

}  // namespace ETCM_IDS
}  // namespace etcm
