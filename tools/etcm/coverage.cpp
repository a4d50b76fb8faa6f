#include "coverage.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <vector>

#include "circle_search.h"
#include "etcm/files/outline.h"
#include "etcm/predicates.h"
#include "hull.h"

namespace etcm::cli {

namespace {

using Violation = std::optional<std::string>;
using files::DirectedEdge;

class Triangles {
 public:
  explicit Triangles(const Claim& claim) : claim_(claim) {
    for (const auto& vertex : claim.image.vertices) points_.push_back(vertex.point);
  }

  Violation check() {
    if (Violation violation = check_orientation()) return violation;
    if (Violation violation = check_sides()) return violation;
    if (Violation violation = check_delaunay()) return violation;
    if (Violation violation = check_fans()) return violation;
    if (Violation violation = check_crossings()) return violation;
    if (Violation violation = check_outline()) return violation;
    return check_holes();
  }

 private:
  const auto& triangles() const { return claim_.image.triangles; }

  Violation check_orientation() const {
    for (std::size_t i = 0; i < triangles().size(); ++i) {
      const auto& [a, b, c] = triangles()[i];
      const int turn = orient2d(points_[a], points_[b], points_[c]);
      if (turn > 0) continue;
      return claim_.triangle(i) + (turn == 0 ? " is flat" : " is clockwise");
    }
    return std::nullopt;
  }

  Violation check_sides() const {
    std::vector<DirectedEdge> sides;
    for (const auto& corner : triangles()) {
      for (std::size_t i = 0; i < 3; ++i) sides.emplace_back(corner[i], corner[(i + 1) % 3]);
    }
    std::sort(sides.begin(), sides.end());
    const auto twice = std::adjacent_find(sides.begin(), sides.end());
    if (twice == sides.end()) return std::nullopt;
    return claim_.edge(twice->first, twice->second) + " has two triangles on one side";
  }

  Violation check_delaunay() const {
    const CircleSearch search(points_);
    for (std::size_t i = 0; i < triangles().size(); ++i) {
      const auto& [a, b, c] = triangles()[i];
      if (const auto inside = search.inside(points_[a], points_[b], points_[c])) {
        return claim_.vertex(*inside) + " is inside the circumcircle of " + claim_.triangle(i);
      }
    }
    return std::nullopt;
  }

  // Whether the direction at -> a comes before at -> b, counter-clockwise from the positive x axis.
  bool turns_before(std::uint32_t at, std::uint32_t a, std::uint32_t b) const {
    const bool a_low = is_below(at, a);
    const bool b_low = is_below(at, b);
    if (a_low != b_low) return b_low;
    return orient2d(points_[at], points_[a], points_[b]) > 0;
  }
  bool is_below(std::uint32_t at, std::uint32_t other) const {
    const Point& from = points_[at];
    const Point& to = points_[other];
    return to.y < from.y || (to.y == from.y && to.x < from.x);
  }

  // Two triangles that share a corner must not share more than an edge there.
  Violation check_fans() const {
    struct Wedge {
      std::uint32_t at, first, last;
      std::size_t triangle;
    };
    std::vector<Wedge> wedges;
    for (std::size_t t = 0; t < triangles().size(); ++t) {
      const auto& corner = triangles()[t];
      for (std::size_t i = 0; i < 3; ++i) {
        wedges.push_back({corner[i], corner[(i + 1) % 3], corner[(i + 2) % 3], t});
      }
    }
    std::sort(wedges.begin(), wedges.end(), [&](const Wedge& a, const Wedge& b) {
      return a.at != b.at ? a.at < b.at : turns_before(a.at, a.first, b.first);
    });
    for (std::size_t begin = 0, end; begin < wedges.size(); begin = end) {
      end = begin + 1;
      while (end < wedges.size() && wedges[end].at == wedges[begin].at) ++end;
      for (std::size_t i = begin; end - begin > 1 && i < end; ++i) {
        const Wedge& wedge = wedges[i];
        const Wedge& next = wedges[i + 1 < end ? i + 1 : begin];
        const Point& apex = points_[wedge.at];
        const Point& direction = points_[next.first];
        const int after_first = orient2d(apex, points_[wedge.first], direction);
        const bool same =
            after_first == 0 && is_below(wedge.at, wedge.first) == is_below(wedge.at, next.first);
        if (same || (after_first > 0 && orient2d(apex, direction, points_[wedge.last]) > 0)) {
          return claim_.triangle(wedge.triangle) + " and " + claim_.triangle(next.triangle) +
                 " overlap at " + claim_.vertex(wedge.at);
        }
      }
    }
    return std::nullopt;
  }

  bool cross(const files::ImageSubsegment& one, const files::ImageSubsegment& other) const {
    const Point& a = points_[one.from];
    const Point& b = points_[one.to];
    const Point& c = points_[other.from];
    const Point& d = points_[other.to];
    return orient2d(a, b, c) * orient2d(a, b, d) < 0 && orient2d(c, d, a) * orient2d(c, d, b) < 0;
  }

  // Sweeps over x; only subsegments that share an x and a y are compared.
  Violation check_crossings() const {
    struct Extent {
      std::int64_t left, right, low, high;
      std::size_t subsegment;
    };
    const auto& subsegments = claim_.image.subsegments;
    std::vector<Extent> extents;
    for (std::size_t i = 0; i < subsegments.size(); ++i) {
      const Point& a = points_[subsegments[i].from];
      const Point& b = points_[subsegments[i].to];
      extents.push_back(
          {std::min(a.x, b.x), std::max(a.x, b.x), std::min(a.y, b.y), std::max(a.y, b.y), i});
    }
    std::sort(extents.begin(), extents.end(),
              [](const Extent& a, const Extent& b) { return a.left < b.left; });
    std::vector<Extent> open;
    for (const Extent& extent : extents) {
      std::erase_if(open, [&](const Extent& other) { return other.right < extent.left; });
      for (const Extent& other : open) {
        if (other.low > extent.high || other.high < extent.low) continue;
        const auto& one = subsegments[other.subsegment];
        const auto& two = subsegments[extent.subsegment];
        if (cross(one, two)) {
          return "subsegments " + claim_.edge(one.from, one.to) + " and " +
                 claim_.edge(two.from, two.to) + " cross";
        }
      }
      open.push_back(extent);
    }
    return std::nullopt;
  }

  Violation check_outline() {
    outline_ = files::outline_edges(claim_.image);
    const std::vector<DirectedEdge> hull = hull_edges(points_);
    if (hull.empty()) {
      if (triangles().empty()) return check_path();
      return std::nullopt;  // not to be reached: collinear vertices have flat triangles only
    }
    if (outline_ == hull) {
      const std::size_t expected = 2 * points_.size() - 2 - hull.size();
      if (triangles().size() == expected) return std::nullopt;
      return "the mesh has " + std::to_string(triangles().size()) +
             " triangles; by Euler's formula it must have " + std::to_string(expected);
    }
    if (triangles().empty() && claim_.grid.holes.empty()) return "the mesh has no triangles";
    std::set<DirectedEdge> allowed(hull.begin(), hull.end());
    for (const auto& subsegment : claim_.image.subsegments) {
      allowed.insert({subsegment.from, subsegment.to});
      allowed.insert({subsegment.to, subsegment.from});
    }
    for (const DirectedEdge& edge : outline_) {
      if (!allowed.contains(edge)) {
        return claim_.edge(edge.first, edge.second) +
               " bounds the triangles, but is neither on the hull nor part of a feature";
      }
    }
    return std::nullopt;
  }

  // Collinear vertices: each neighbouring pair is an edge, and no other.
  Violation check_path() const {
    std::vector<std::uint32_t> order(points_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return points_[a] < points_[b]; });
    for (std::size_t i = 1; i < order.size(); ++i) {
      if (files::find_edge(claim_.image, order[i - 1], order[i]) == claim_.image.edges.size()) {
        return claim_.edge(order[i - 1], order[i]) + " between neighbours on the line is missing";
      }
    }
    if (claim_.image.edges.size() + 1 > std::max<std::size_t>(order.size(), 1)) {
      return "the mesh has edges beside the line through its vertices";
    }
    return std::nullopt;
  }

  // What the triangles leave out within their outline must be a hole of the input, and no hole of
  // the input may be covered.
  Violation check_holes() const {
    for (std::size_t i = 0; i < claim_.grid.holes.size(); ++i) {
      const Side place = locate_in(outline_, claim_.grid.holes[i]);
      if (place == Side::inside) {
        return "hole " + std::to_string(i + 1) + " of the input is covered by triangles";
      }
    }
    for (const auto& loop : gaps()) {
      const bool has_seed =
          std::any_of(claim_.grid.holes.begin(), claim_.grid.holes.end(),
                      [&](const Point& seed) { return locate_in(loop, seed) == Side::inside; });
      if (!has_seed) {
        return "the gap beside " + claim_.edge(loop.front().first, loop.front().second) +
               " is enclosed by triangles, but the input has no hole there";
      }
    }
    return std::nullopt;
  }

  enum class Side { inside, outside, on_line };

  // Counts the edges that pass to the right of the point.
  Side locate_in(const std::vector<DirectedEdge>& edges, const Point& point) const {
    bool is_inside = false;
    for (const auto& [from, to] : edges) {
      const Point& a = points_[from];
      const Point& b = points_[to];
      const int side = orient2d(a, b, point);
      if (side == 0 && std::min(a, b) <= point && point <= std::max(a, b)) return Side::on_line;
      if ((a.y <= point.y) == (b.y <= point.y)) continue;
      if ((side > 0) == (a.y <= point.y)) is_inside = !is_inside;
    }
    return is_inside ? Side::inside : Side::outside;
  }

  // The bounded faces of what is not covered, as loops that have it on the left.
  std::vector<std::vector<DirectedEdge>> gaps() const {
    std::vector<DirectedEdge> reversed;
    for (const auto& [from, to] : outline_) reversed.emplace_back(to, from);
    std::sort(reversed.begin(), reversed.end());
    std::vector<bool> used(reversed.size(), false);
    std::vector<std::vector<DirectedEdge>> found;
    for (std::size_t start = 0; start < reversed.size(); ++start) {
      if (used[start]) continue;
      std::vector<DirectedEdge> loop;
      for (std::size_t at = start; !used[at]; at = next_in_face(reversed, at)) {
        used[at] = true;
        loop.push_back(reversed[at]);
      }
      if (encloses_its_left(loop)) found.push_back(std::move(loop));
    }
    return found;
  }

  // The edge that goes on around the same face: the first one clockwise from where we came.
  std::size_t next_in_face(const std::vector<DirectedEdge>& edges, std::size_t index) const {
    const auto [from, at] = edges[index];
    auto candidate = std::lower_bound(edges.begin(), edges.end(), DirectedEdge(at, 0));
    auto best = candidate;
    for (; candidate != edges.end() && candidate->first == at; ++candidate) {
      if (is_clockwise_nearer(at, from, candidate->second, best->second)) best = candidate;
    }
    return static_cast<std::size_t>(best - edges.begin());
  }

  // Turning clockwise at `at` from `start`: does `a` come before `b`?
  bool is_clockwise_nearer(std::uint32_t at, std::uint32_t start, std::uint32_t a,
                           std::uint32_t b) const {
    // Counter-clockwise from the x axis, the nearest clockwise is the last one before the start, or
    // else the last of all.
    const bool a_before = turns_before(at, a, start);
    const bool b_before = turns_before(at, b, start);
    if (a_before != b_before) return a_before;
    return turns_before(at, b, a);
  }

  // Whether the loop turns left wherever it passes its least vertex: then the face on its left is
  // bounded by it from outside.
  bool encloses_its_left(const std::vector<DirectedEdge>& loop) const {
    std::uint32_t least = loop.front().first;
    for (const auto& [from, to] : loop) {
      if (points_[from] < points_[least]) least = from;
    }
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const DirectedEdge& into = loop[i];
      const DirectedEdge& out = loop[(i + 1) % loop.size()];
      if (into.second == least &&
          orient2d(points_[into.first], points_[least], points_[out.second]) <= 0) {
        return false;
      }
    }
    return true;
  }

  const Claim& claim_;
  std::vector<Point> points_;
  std::vector<DirectedEdge> outline_;
};

}  // namespace

std::optional<std::string> first_triangle_violation(const Claim& claim) {
  return Triangles(claim).check();
}

}  // namespace etcm::cli
