// Where no sensor reaches: see coverage_holes() in analysis.h for why these places are all.
#include <algorithm>

#include "analysis/internal.h"
#include "geometry/predicates_inline.h"
#include "geometry/wide_int.h"
#include "triangulation/circle_walk.h"
#include "triangulation/hints.h"
#include "triangulation/locate.h"
#include "triangulation/march.h"
#include "triangulation/mesh_state.h"
#include "triangulation/pulse.h"
#include "triangulation/segment_store.h"

namespace etcm {
inline namespace ETCM_IDS {

using namespace internal;

namespace {

// The circumcentre of a counter-clockwise triangle, as seen from its first corner: (x, y) / scale.
// The parts are below 2^162, scale below 2^109.
struct Centre {
  Point origin;
  Int256 x;
  Int256 y;
  Int128 scale;

  Centre(const Point& a, const Point& b, const Point& c) noexcept : origin(a) {
    const Vector ab = between(a, b), ac = between(a, c);
    const Int128 b_lift = dot(ab, ab), c_lift = dot(ac, ac);
    x = Wide::product(b_lift, widened(ac.y)) - Wide::product(c_lift, widened(ab.y));
    y = Wide::product(c_lift, widened(ab.x)) - Wide::product(b_lift, widened(ac.x));
    scale = twice(cross(ab, ac));
  }

  // For a triangle that is not obtuse: the centre lies in it.
  Point rounded() const noexcept {
    return {origin.x + rounded_quotient(x, scale), origin.y + rounded_quotient(y, scale)};
  }

  // The side of u -> v on which it lies, exactly: orient2d(u, v, centre). Times scale, the centre
  // as seen from u is below 2^164, and the cross product below 2^219.
  int side_of(const Point& u, const Point& v) const noexcept {
    const Vector uv = between(u, v), to_origin = between(u, origin);
    const Int256 from_x = Wide::product(scale, widened(to_origin.x)) + x;
    const Int256 from_y = Wide::product(scale, widened(to_origin.y)) + y;
    return Wide::sign(Wide::product(widened(widened(uv.x)), from_y) -
                      Wide::product(widened(widened(uv.y)), from_x));
  }
};

class Coverage {
 public:
  // Without a domain: the hull.
  Coverage(const MeshState& sensors, const MeshState* domain, std::span<const Region> region,
           std::uint32_t range, std::span<Hole> out) noexcept
      : m_(sensors), range_(range), out_(out), domain_(domain), region_(region), pulse_(sensors) {}

  std::uint32_t run() noexcept {
    if (m_.vertex_count() == 0) return 0;
    for (IdValue t = 0; t < m_.topology.triangle_count(); ++t) visit(t);
    if (domain_ == nullptr) {
      visit_hull();
    } else {
      visit_boundary(*domain_);
    }
    return count_;
  }

 private:
  void add(const Hole& hole) noexcept {
    if (count_ < out_.size()) out_[count_] = hole;
    ++count_;
  }

  // --- inside

  void visit(IdValue t) noexcept {
    pulse_.pass(60);
    const Topology& topo = m_.topology;
    if (topo.is_ghost(t)) return;
    SquaredLength length[3];  // of the side opposite each corner
    unsigned longest = 0;
    for (unsigned i = 0; i < 3; ++i) {
      const Edge e = Topology::edge(t, i);
      length[i] = squared_distance(m_.at(topo.origin(e)), m_.at(topo.target(e)));
      if (length[i] > length[longest]) longest = i;
    }
    const SquaredLength others = sum(length[(longest + 1) % 3], length[(longest + 2) % 3]);
    if (others < length[longest]) return;
    // A right angle: the centre is on the longest side. It is a peak if the triangle beyond has a
    // right angle there too, and then one of the two is enough.
    if (others == length[longest] && !is_first_of_two(Topology::edge(t, longest))) return;
    if (!is_wide(t, length, length[longest])) return;
    const TriangleRecord& r = topo.triangle(t);
    const Centre centre(m_.at(r.corner[0]), m_.at(r.corner[1]), m_.at(r.corner[2]));
    // The place is costly to find; where the list is full, the count alone does without.
    if (domain_ == nullptr && count_ >= out_.size()) {
      ++count_;
      return;
    }
    pulse_.pass(128);
    const Point place = centre.rounded();
    if (is_in_domain(centre, place)) add({place, m_.at(r.corner[0]), false});
  }

  bool is_first_of_two(Edge e) const noexcept {
    const Edge f = m_.topology.twin(e);
    const VertexId apex = m_.topology.apex(f);
    if (apex == infinite_vertex || e.value > f.value) return false;
    const Point& from = m_.at(m_.topology.origin(e));
    const Point& to = m_.at(m_.topology.target(e));
    return sum(squared_distance(from, m_.at(apex)), squared_distance(to, m_.at(apex))) ==
           squared_distance(from, to);
  }

  // Whether the circumradius R of a triangle that is not obtuse is beyond the range: its longest
  // side is between sqrt(3) R and 2 R, and in between a^2 b^2 c^2 > 4 range^2 (2 area)^2 decides,
  // with 321 bits on the left and, where the shorter tests leave it open, as many on the right.
  bool is_wide(IdValue t, const SquaredLength (&length)[3],
               const SquaredLength& longest) const noexcept {
    if (longest > squared_range(range_, 1)) return true;
    const SquaredLength square = squared_range(range_, 0);
    if (longest <= sum(square, sum(square, square))) return false;
    const TriangleRecord& r = m_.topology.triangle(t);
    const Point& a = m_.at(r.corner[0]);
    const Int128 area = cross(between(a, m_.at(r.corner[1])), between(a, m_.at(r.corner[2])));
    const Int512 sides =
        Wide::product(Wide::product(limbs(length[0]), limbs(length[1])), widened(limbs(length[2])));
    const Int512 limit =
        Wide::product(Wide::product(area, area), widened(limbs(squared_range(range_, 1))));
    return Wide::sign(sides - limit) > 0;
  }

  bool is_inside(IdValue t) const noexcept {
    return !domain_->topology.is_ghost(t) && region_[t] == Region::inside;
  }

  // Whether the centre is in the domain and not on its boundary, which is visited for itself. The
  // rounded place leads close; from there a visibility walk with the exact one, as in locate.cpp.
  bool is_in_domain(const Centre& centre, const Point& place) const noexcept {
    if (domain_ == nullptr) return true;
    const MeshState& d = *domain_;
    const Topology& topo = d.topology;
    IdValue t = Topology::triangle_of(find(d, place, edge_near(d, place)).edge);
    if (topo.is_ghost(t)) {
      unsigned side = 0;
      while (topo.triangle(t).corner[side] != infinite_vertex) ++side;
      t = Topology::triangle_of(topo.twin(Topology::edge(t, side)));
    }
    for (StepBound bound(topo.triangle_count());; bound.step()) {
      unsigned zeros = 0, zero_side = 0, nonzero_side = 0;
      Edge across;
      for (unsigned side = 0; side < 3 && across.is_none(); ++side) {
        const Edge e = Topology::edge(t, side);
        const int sign = centre.side_of(d.at(topo.origin(e)), d.at(topo.target(e)));
        if (sign < 0) across = topo.twin(e);
        if (sign == 0) ++zeros, zero_side = side;
        if (sign > 0) nonzero_side = side;
      }
      if (!across.is_none()) {
        t = Topology::triangle_of(across);
        if (topo.is_ghost(t)) return false;
        continue;
      }
      if (zeros == 0) return is_inside(t);
      if (zeros == 1) {
        return is_inside(t) &&
               is_inside(Topology::triangle_of(topo.twin(Topology::edge(t, zero_side))));
      }
      return is_inside_around(topo.triangle(t).corner[nonzero_side]);
    }
  }

  bool is_inside_around(VertexId v) const noexcept {
    const Topology& topo = domain_->topology;
    Spokes spokes(topo, v);
    do {
      if (!is_inside(Topology::triangle_of(spokes.edge()))) return false;
    } while (spokes.turn());
    return true;
  }

  // --- the boundary

  void visit_hull() noexcept {
    const bool flat = is_flat(m_);
    for_each_edge(m_, [&](Edge e) noexcept {
      const bool on_hull = flat || m_.topology.apex(e) == infinite_vertex ||
                           m_.topology.apex(m_.topology.twin(e)) == infinite_vertex;
      if (on_hull) visit_segment(m_.at(m_.topology.origin(e)), m_.at(m_.topology.target(e)));
    });
  }

  // Segments of features with the domain on one side only, and edges of the hull that belong to
  // none. A feature crosses no other, so the subsegments of a segment have the same on their sides.
  void visit_boundary(const MeshState& d) noexcept {
    for (IdValue value = 0; value < d.segment_end; ++value) {
      const SegmentId s{value};
      if (!is_linked(d, s)) continue;
      const Subsegment subsegment = march(d, d.segment(s).from, d.segment(s).to);
      if (subsegment.is_edge && bounds(d, subsegment.edge)) {
        visit_segment(d.at(d.segment(s).from), d.at(d.segment(s).to));
      }
    }
    for_each_edge(d, [&](Edge e) noexcept {
      if (d.topology.is_constrained(e) || !bounds(d, e)) return;
      visit_segment(d.at(d.topology.origin(e)), d.at(d.topology.target(e)));
    });
    for (IdValue value = 1; value < d.vertex_end; ++value) {
      if (d.is_node(VertexId{value})) visit_corner(d, VertexId{value});
    }
  }

  bool bounds(const MeshState& d, Edge e) const noexcept {
    return is_inside(Topology::triangle_of(e)) !=
           is_inside(Topology::triangle_of(d.topology.twin(e)));
  }

  // Between its ends.
  void visit_segment(const Point& from, const Point& to) noexcept {
    pulse_.pass(64);
    const VertexId start = nearest_vertex(m_, from).node;
    // Sensors at both ends see all of it.
    if (squared_distance(from, to) <= squared_range(range_, 1) && m_.at(start) == from &&
        m_.at(nearest_vertex(m_, to).node) == to) {
      return;
    }
    NearestWalk walk(m_, from, to, start);
    while (walk.next()) {
      pulse_.pass(64);
      if (!walk.is_peak() || !walk.is_beyond(range_)) continue;
      // The place is costly to find; where the list is full, the count alone does without.
      if (count_ < out_.size()) {
        out_[count_] = {walk.place(), m_.at(walk.handover().before), true};
      }
      ++count_;
    }
  }

  // Where segments end: a peak if the distance falls along each of them.
  void visit_corner(const MeshState& d, VertexId corner) noexcept {
    pulse_.pass(20);
    const Point& place = d.at(corner);
    Spokes spokes(d.topology, corner);
    VertexId start{};
    do {
      if (!bounds(d, spokes.edge())) continue;
      if (start.is_none()) start = nearest_vertex(m_, place).node;
      if (squared_distance(place, m_.at(start)) <= squared_range(range_, 0)) return;
      if (!NearestWalk(m_, place, d.at(spokes.target()), start).falls_at_start()) return;
    } while (spokes.turn());
    if (!start.is_none()) add({place, m_.at(start), true});
  }

  const MeshState& m_;
  const std::uint32_t range_;
  const std::span<Hole> out_;
  const MeshState* const domain_;
  const std::span<const Region> region_;
  Pulse pulse_;
  std::uint32_t count_ = 0;
};

}  // namespace

std::uint32_t coverage_holes(const Mesh& sensors, const Domain& domain, std::uint32_t sensing_range,
                             std::span<Hole> out) noexcept {
  const MeshState& m = opened(sensors, Call::coverage_holes);
  demand(sensing_range != 0, Call::coverage_holes, Fault::zero_range);
  const MeshState* d = nullptr;
  if (domain.mesh != nullptr) d = &opened(*domain.mesh, Call::coverage_holes);
  if (d == nullptr || d->topology.triangle_count() == 0 || is_flat(*d)) {
    return Coverage(m, nullptr, {}, sensing_range, out).run();
  }
  demand(domain.region.size() >= d->topology.triangle_count(), Call::coverage_holes,
         Fault::no_region);
  return Coverage(m, d, domain.region, sensing_range, out).run();
}

}  // namespace ETCM_IDS
}  // namespace etcm
