// A vertex joins the triangulation: split the triangle it lies in, then turn the edges of its link
// that are no longer Delaunay. Walking around the link needs no list of edges, so there is no
// scratch memory to run out of: once its vertex has a place, an insertion can fail only for want of
// work. That is known before anything is turned.
#include "triangulation/insert.h"

#include "geometry/predicates_inline.h"
#include "triangulation/change.h"
#include "triangulation/locate.h"
#include "triangulation/mesh_state.h"
#include "triangulation/relative.h"
#include "triangulation/remove.h"
#include "triangulation/segment_store.h"
#include "triangulation/ties.h"

namespace etcm::internal {
namespace {

// A subsegment that breaks has to be put back, or laid anew and taken out again: it is found by a
// few turns around its first end.
constexpr std::uint32_t work_of_subsegment = 32;
constexpr std::uint32_t turns_of_subsegment = 3;

unsigned degree_at(const MeshState& m, Edge e) noexcept {
  const VertexId u = m.topology.origin(e), v = m.topology.target(e);
  return m.topology.degree(m.at(u) < m.at(v) ? u : v, m.work.left());
}

void break_subsegment(Change& change, Edge e) noexcept {
  MeshState& m = change.mesh;
  const VertexId u = m.topology.origin(e), v = m.topology.target(e);
  const SegmentId s = segment_of_edge(m, u, v);
  const Units degree = degree_at(m, e);
  m.work.add(degree + change.dirty.size() + 1);
  m.work.keep(turns_of_subsegment * degree + work_of_subsegment);
  touch(change, s, u, v);
  make_dirty(change, s);
  ++change.broken_count;
}

// So many flips: the triangles beyond that many edges and as many again are looked at, beforehand
// too; and the vertex may have to be found again, and taken out.
Units work_of_flips(Units flips) noexcept { return work_of_flip * flips + 18; }
Units work_back(Units flips) noexcept {
  // Those that come after it may leave it with more neighbours than it has now.
  return removal_work(3 + flips) + 24 * flips + 16;
}

// A subsegment that breaks may have been a chord of an empty circle: when it comes back ties turn.
// All that stand on that circle are in the way of what has come into it, and few of them are within
// what is kept anyway.
Units work_of_chords(Units breaks, Units flips) noexcept {
  constexpr Units few = 8;
  return flips < few ? 0 : work_of_chord * breaks * flips;
}

// Of many edges of a link the meter is told while they are looked at. They are counted by the
// flips, before or after; but each may take as long as one, and most of a long link may stay.
constexpr std::uint32_t edges_between = 8;

// For what those that break are found to take beforehand and while others flip: each flip may take
// one of a degree, or put a segment into the list.
Units work_in_doubt(Units breaks, Units flips) noexcept { return breaks * flips; }

// What an insertion does and breaks, before it does.
class Conflicts {
 public:
  Conflicts(const Change& change, const Point& p) noexcept
      : m_(change.mesh), p_(p), listing_(change.dirty.size()) {}

  // Counts the triangles beyond the edge in whose circles p lies; they hang together like a tree,
  // so along its sides the walk comes back. False: there is no room for them.
  // Not inline, for it is called three times.
  [[gnu::noinline]] bool count_beyond(Edge first) noexcept {
    const Topology& topo = m_.topology;
    if (!must_flip(m_, first, p_)) return true;
    enter(first);
    const Edge back = topo.twin(first);
    Units crossed = 0;
    for (Edge e = Topology::next(back); e != back;) {
      if (!must_flip(m_, e, p_)) {
        e = Topology::next(e);
        continue;
      }
      m_.work.pass(work_of_flips(1));
      // Each edge of the tree twice, there and back.
      if ((++crossed & 1u) != 0) enter(e);
      if (!has_room()) return false;
      e = Topology::next(topo.twin(e));
    }
    return true;
  }
  void add_flips(std::uint32_t flips) noexcept { flips_ += flips; }
  Units needed() const noexcept {
    return work_of_flips(flips_) + work_of_breaks_ + work_in_doubt(breaks_, flips_) +
           m_.work.to_keep(work_back(flips_) + kept_ + work_of_chords(breaks_, flips_));
  }

 private:
  bool has_room() const noexcept { return m_.work.has_room(needed()); }
  void enter(Edge e) noexcept {
    ++flips_;
    if (!m_.topology.is_constrained(e)) return;
    const Units degree = degree_at(m_, e);
    ++breaks_;
    work_of_breaks_ += degree + listing_ + 1;
    kept_ += turns_of_subsegment * degree + work_of_subsegment;
  }

  MeshState& m_;
  const Point p_;
  Units listing_;
  Units flips_ = 0;
  Units breaks_ = 0;
  Units work_of_breaks_ = 0;
  Units kept_ = 0;
};

// Whether there is room for the work of an insertion there.
// Not inline, or each insertion would have its room on the stack.
[[gnu::noinline]] bool fits(Change& change, const Point& p, const Found& found) noexcept {
  MeshState& m = change.mesh;
  Conflicts conflicts(change, p);
  if (is_flat(m)) {
    // All the ghosts on one side but the one that it is in, or the two of an edge.
    conflicts.add_flips(found.type == LocateType::on_edge ? 1u
                                                          : m.topology.triangle_count() / 2u - 1u);
    return m.work.fits(conflicts.needed());
  }
  const Edge e = found.edge;
  const bool is_counted = conflicts.count_beyond(e) && conflicts.count_beyond(Topology::next(e)) &&
                          conflicts.count_beyond(Topology::prev(e));
  return m.work.fits(conflicts.needed()) && is_counted;
}

}  // namespace

// Each vertex of the link is looked at once, and each pair of neighbours.
std::uint32_t legalize_link(MeshState& m, Edge e, VertexId last, const Point& p,
                            Change* change) noexcept {
  Topology& topo = m.topology;
  Relative u = relative_to(m, topo.origin(e), p);
  Relative v = relative_to(m, topo.target(e), p);
  double uv = cross_value(u.at, v.at);
  std::uint32_t flips = 0;
  for (std::uint32_t looked = 1;; ++looked) {
    if (looked % edges_between == 0) m.work.pass(edges_between * work_of_flip);
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
        ++flips;
        v = w;
        uv = uw;
        continue;
      }
    }
    if (v.id == last) {
      m.walk_start = e;
      return flips;
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

bool insert_vertex(Change& change, VertexId v, const Found& found) noexcept {
  MeshState& m = change.mesh;
  Topology& topo = m.topology;
  const bool is_at_end = found.type == LocateType::outside && !found.vertex.is_none();
  if ((topo.triangle_count() == 0 || is_at_end) && !m.work.may_keep(work_back(0))) return false;
  if (topo.triangle_count() == 0) {
    if (m.only_vertex.is_none()) {
      m.only_vertex = v;
    } else {
      topo.start(m.only_vertex, v);
      m.only_vertex = VertexId::none();
    }
    return true;
  }
  if (is_at_end) {
    // A collinear mesh grows at its end; found.edge runs from there to infinity.
    topo.split_open(found.edge, v);
    m.walk_start = topo.edge_at(v);
    return true;
  }
  const Point& p = m.at(v);
  // With so much room nobody need count.
  constexpr Units ample = 96;
  if (!m.work.has_room(ample * topo.triangle_count()) && !fits(change, p, found)) return false;
  Edge e = topo.split_triangle(Topology::triangle_of(found.edge), v);
  // Where p lies on an edge, the triangle between is flat until that edge flips (p is inside any
  // circle through its ends), so it flips first: in a collinear mesh both its triangles are ghosts
  // that share their other edges too, and must not be met from there.
  for (unsigned side = Topology::side_of(found.edge); side != 0; --side) {
    e = topo.next_link_edge(e);
  }
  const std::uint32_t broken_before = change.broken_count;
  const std::uint32_t flips = legalize_link(m, e, topo.origin(e), p, &change);
  m.work.add(work_of_flips(flips));
  m.work.keep(work_back(flips));
  const std::uint32_t broken = change.broken_count - broken_before;
  if (broken != 0) {
    m.work.keep(work_of_chords(broken, flips));
    static_cast<void>(m.work.fits(turns_of_subsegment * work_in_doubt(broken, flips) +
                                  work_in_doubt(broken, 2 * Units{flips})));
  }
  return true;
}

}  // namespace etcm::internal
