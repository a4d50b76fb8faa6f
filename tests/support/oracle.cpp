#include "support/oracle.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "etcm/audit.h"
#include "support/big_integer.h"
#include "support/exact.h"

namespace etcm::test {
namespace {

using testing::AssertionFailure;
using testing::AssertionResult;
using testing::AssertionSuccess;
using Edge = std::pair<VertexId, VertexId>;

std::string text(VertexId vertex) { return std::to_string(vertex.value); }
std::string text(const Edge& edge) { return text(edge.first) + "-" + text(edge.second); }

Edge undirected(VertexId a, VertexId b) { return {std::min(a, b), std::max(a, b)}; }

std::vector<VertexId> vertices_of(const Mesh& mesh) {
  std::vector<VertexId> vertices;
  for (IdValue value = 1; value < mesh.vertex_id_end(); ++value) {
    if (mesh.kind(VertexId{value}) != VertexKind::none) vertices.push_back(VertexId{value});
  }
  return vertices;
}

std::vector<Triangle> finite_triangles_of(const Mesh& mesh) {
  std::vector<Triangle> triangles;
  for (IdValue value = 0; value < mesh.triangle_count(); ++value) {
    const Triangle triangle = mesh.triangle(TriangleId{value});
    if (!triangle.is_ghost()) triangles.push_back(triangle);
  }
  return triangles;
}

// The corners of the convex hull, counter-clockwise, collinear ones left out.
std::vector<Point> convex_hull(std::vector<Point> points) {
  std::sort(points.begin(), points.end());
  std::vector<Point> hull;
  const auto extend = [&hull](const Point& point, std::size_t kept) {
    while (hull.size() >= kept + 2 &&
           exact_orientation(hull[hull.size() - 2], hull.back(), point) <= 0) {
      hull.pop_back();
    }
    hull.push_back(point);
  };
  for (const Point& point : points) extend(point, 0);
  const std::size_t lower = hull.size();
  for (std::size_t i = points.size() - 1; i-- > 0;) extend(points[i], lower - 1);
  if (hull.size() > 1) hull.pop_back();
  return hull;
}

// Sum of the cross products along a closed path: twice the area it encloses.
template <class Points>
mpz_class doubled_area(const Points& path) {
  mpz_class sum = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Point& a = path[i];
    const Point& b = path[(i + 1) % path.size()];
    sum += integer(a.x) * integer(b.y) - integer(a.y) * integer(b.x);
  }
  return sum;
}

class Oracle {
 public:
  explicit Oracle(const Mesh& mesh)
      : mesh_(mesh), vertices_(vertices_of(mesh)), triangles_(finite_triangles_of(mesh)) {
    for (const VertexId vertex : vertices_) points_.push_back(mesh.point(vertex));
  }

  AssertionResult check() {
    for (const auto rule : {&Oracle::counts, &Oracle::circles, &Oracle::ties, &Oracle::cover,
                            &Oracle::stars, &Oracle::features}) {
      if (AssertionResult result = (this->*rule)(); !result) return result;
    }
    return AssertionSuccess();
  }

 private:
  AssertionResult counts() {
    if (vertices_.size() != mesh_.node_count() + mesh_.steiner_count()) {
      return AssertionFailure() << "vertices in use and counts disagree";
    }
    if (triangles_.size() != mesh_.finite_triangle_count()) {
      return AssertionFailure() << "finite triangles and their count disagree";
    }
    std::set<Point> distinct(points_.begin(), points_.end());
    if (distinct.size() != points_.size()) return AssertionFailure() << "two vertices on one spot";
    return AssertionSuccess();
  }

  AssertionResult circles() {
    for (const Triangle& triangle : triangles_) {
      const Point a = mesh_.point(triangle.corner[0]);
      const Point b = mesh_.point(triangle.corner[1]);
      const Point c = mesh_.point(triangle.corner[2]);
      if (exact_orientation(a, b, c) <= 0) return AssertionFailure() << "a flat or turned triangle";
      for (const Point& d : points_) {
        if (d == a || d == b || d == c) continue;
        if (exact_incircle(a, b, c, d) > 0) {
          return AssertionFailure() << "(" << d.x << ", " << d.y << ") is in the circle of "
                                    << text(triangle.corner[0]) << ", " << text(triangle.corner[1])
                                    << ", " << text(triangle.corner[2]);
        }
      }
    }
    return AssertionSuccess();
  }

  // Ties: an edge of no feature is the one the perturbation asks for. That it holds at each edge
  // makes it hold everywhere, as for any constrained Delaunay mesh of points in general position.
  AssertionResult ties() {
    for (const Triangle& triangle : triangles_) {
      for (std::size_t side = 0; side < 3; ++side) {
        const Triangle beyond = mesh_.triangle(triangle.neighbour[side]);
        if (triangle.constrained[side] || beyond.is_ghost()) continue;
        const Point a = mesh_.point(triangle.corner[0]);
        const Point b = mesh_.point(triangle.corner[1]);
        const Point c = mesh_.point(triangle.corner[2]);
        for (const VertexId apex : beyond.corner) {
          if (std::count(triangle.corner.begin(), triangle.corner.end(), apex) > 0) continue;
          if (exact_incircle_perturbed(a, b, c, mesh_.point(apex)) >= 0) {
            return AssertionFailure() << "a tie between " << text(apex) << " and the triangle "
                                      << "across is broken the wrong way";
          }
        }
      }
    }
    return AssertionSuccess();
  }

  // Counter-clockwise triangles with the hull's area in sum, no directed edge twice: with empty
  // circles, no two overlap and nothing is left uncovered.
  AssertionResult cover() {
    mpz_class area = 0;
    std::set<Edge> directed;
    for (const Triangle& triangle : triangles_) {
      std::array<Point, 3> corners;
      for (std::size_t i = 0; i < 3; ++i) {
        corners[i] = mesh_.point(triangle.corner[i]);
        const Edge edge{triangle.corner[i], triangle.corner[(i + 1) % 3]};
        if (!directed.insert(edge).second) {
          return AssertionFailure() << "edge " << text(edge) << " has two triangles on one side";
        }
        edges_.insert(undirected(edge.first, edge.second));
        if (triangle.constrained[(i + 2) % 3]) marked_.insert(undirected(edge.first, edge.second));
      }
      area += doubled_area(corners);
    }
    const std::vector<Point> hull = points_.empty() ? points_ : convex_hull(points_);
    if (area != doubled_area(hull)) return AssertionFailure() << "the hull is not covered";
    if (!triangles_.empty()) {
      std::set<VertexId> covered;
      for (const Triangle& t : triangles_) covered.insert(t.corner.begin(), t.corner.end());
      if (covered.size() != vertices_.size()) return AssertionFailure() << "a vertex is left out";
    }
    return AssertionSuccess();
  }

  // neighbours() and triangle() tell the same; on a line, neighbours are the next ones along it.
  AssertionResult stars() {
    std::set<Edge> from_stars;
    for (const VertexId vertex : vertices_) {
      std::vector<Neighbour> star(mesh_.neighbours(vertex, {}));
      if (mesh_.neighbours(vertex, star) != star.size()) {
        return AssertionFailure() << "neighbours() changed its mind at " << text(vertex);
      }
      for (const Neighbour& neighbour : star) {
        const Edge edge = undirected(vertex, neighbour.vertex);
        from_stars.insert(edge);
        star_marks_[edge].push_back(neighbour.constrained);
        if (neighbour.constrained && triangles_.empty()) marked_.insert(edge);
      }
    }
    if (triangles_.empty()) {
      std::vector<VertexId> line = vertices_;
      std::sort(line.begin(), line.end(),
                [this](VertexId a, VertexId b) { return mesh_.point(a) < mesh_.point(b); });
      for (std::size_t i = 0; i + 1 < line.size(); ++i) {
        edges_.insert(undirected(line[i], line[i + 1]));
      }
    }
    if (from_stars != edges_) return AssertionFailure() << "stars and triangles disagree on edges";
    for (const auto& [edge, marks] : star_marks_) {
      const bool marked = marked_.contains(edge);
      if (marks.size() != 2 || marks[0] != marked || marks[1] != marked) {
        return AssertionFailure() << "stars and triangles disagree on the mark of " << text(edge);
      }
    }
    return AssertionSuccess();
  }

  AssertionResult features() {
    std::set<Edge> owned;
    std::set<VertexId> steiner_seen;
    std::uint32_t count = 0;
    for (IdValue value = 0; value < mesh_.feature_id_end(); ++value) {
      const FeatureId feature{value};
      if (!mesh_.is_feature(feature)) continue;
      ++count;
      std::vector<VertexId> chain(mesh_.chain(feature, {}));
      if (mesh_.chain(feature, chain) != chain.size() || chain.size() < 2) {
        return AssertionFailure() << "feature " << value << " has no chain";
      }
      const FeatureEnds ends = mesh_.ends(feature);
      if (chain.front() != ends.from || chain.back() != ends.to) {
        return AssertionFailure() << "the chain of feature " << value << " misses its ends";
      }
      const Point from = mesh_.point(ends.from);
      const Point to = mesh_.point(ends.to);
      for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
        const Edge edge = undirected(chain[i], chain[i + 1]);
        if (!edges_.contains(edge) || !marked_.contains(edge) || !owned.insert(edge).second) {
          return AssertionFailure() << "subsegment " << text(edge) << " of feature " << value
                                    << " is no edge, not marked, or shared";
        }
        const Point a = mesh_.point(chain[i]);
        const Point b = mesh_.point(chain[i + 1]);
        if (exact_orientation(from, to, b) != 0 || (a < b) != (from < to)) {
          return AssertionFailure() << "feature " << value << " leaves its line or turns back at "
                                    << text(chain[i + 1]);
        }
        if (mesh_.kind(chain[i]) != VertexKind::steiner) continue;
        steiner_seen.insert(chain[i]);
        if (mesh_.feature_of(chain[i]) != feature) {
          return AssertionFailure() << text(chain[i]) << " does not know its feature " << value;
        }
      }
    }
    if (count != mesh_.feature_count()) return AssertionFailure() << "features and count disagree";
    if (owned != marked_) return AssertionFailure() << "an edge of no feature is marked";
    if (steiner_seen.size() != mesh_.steiner_count()) {
      return AssertionFailure() << "a Steiner vertex stands on no feature";
    }
    return AssertionSuccess();
  }

  const Mesh& mesh_;
  std::vector<VertexId> vertices_;
  std::vector<Triangle> triangles_;
  std::vector<Point> points_;
  std::set<Edge> edges_;
  std::set<Edge> marked_;
  std::map<Edge, std::vector<bool>> star_marks_;
};

}  // namespace

AssertionResult passes_audit(const Mesh& mesh) {
  const Audit found = audit(mesh);
  if (found) return AssertionSuccess();
  AssertionResult failure = AssertionFailure();
  failure << "audit: " << to_string(found.broken);
  if (!found.vertex.is_none()) failure << ", vertex " << found.vertex.value;
  if (!found.triangle.is_none()) failure << ", triangle " << found.triangle.value;
  if (!found.feature.is_none()) failure << ", feature " << found.feature.value;
  return failure;
}

AssertionResult passes_oracle(const Mesh& mesh) { return Oracle(mesh).check(); }

AssertionResult is_sound(const Mesh& mesh) {
  AssertionResult audited = passes_audit(mesh);
  return audited ? passes_oracle(mesh) : audited;
}

}  // namespace etcm::test
