#include "analysis_oracle.h"

#include <algorithm>
#include <numeric>

#include "support/big_integer.h"

namespace etcm::test {

namespace {

RationalPoint minus(const RationalPoint& a, const RationalPoint& b) {
  return {a.x - b.x, a.y - b.y};
}
mpq_class dot(const RationalPoint& a, const RationalPoint& b) { return a.x * b.x + a.y * b.y; }
mpq_class cross(const RationalPoint& a, const RationalPoint& b) { return a.x * b.y - a.y * b.x; }

bool is_in(const Mesh& mesh, const Triangle& triangle, const RationalPoint& place) {
  for (std::size_t i = 0; i < 3; ++i) {
    const RationalPoint from = rational(mesh.point(triangle.corner[i]));
    const RationalPoint to = rational(mesh.point(triangle.corner[(i + 1) % 3]));
    if (cross(minus(to, from), minus(place, from)) < 0) return false;
  }
  return true;
}

}  // namespace

RationalPoint rational(const Point& p) {
  return {mpq_class(integer(p.x)), mpq_class(integer(p.y))};
}

mpq_class squared(const RationalPoint& a, const RationalPoint& b) {
  const RationalPoint way = minus(b, a);
  return dot(way, way);
}

mpq_class squared_range(std::uint32_t units) {
  const mpz_class range = mpz_class(units) << subunit_bits;
  return mpq_class(range * range);
}

mpz_class integer(const SquaredLength& length) {
  const auto word = [](std::uint64_t bits) -> mpz_class {
    return (mpz_class(static_cast<unsigned long>(bits >> 32)) << 32) +
           mpz_class(static_cast<unsigned long>(bits & 0xffff'ffff));
  };
  return (word(length.high) << 64) + word(length.low);
}

std::vector<Point> points_of(const Mesh& mesh) {
  std::vector<Point> points;
  for (IdValue value = 1; value < mesh.vertex_id_end(); ++value) {
    if (mesh.kind(VertexId{value}) != VertexKind::none)
      points.push_back(mesh.point(VertexId{value}));
  }
  return points;
}

mpq_class squared_distance_to(const std::vector<Point>& sensors, const RationalPoint& place) {
  mpq_class least = -1;
  for (const Point& sensor : sensors) {
    const mpq_class distance = squared(rational(sensor), place);
    if (least < 0 || distance < least) least = distance;
  }
  return least;
}

// The ends, and the crossings with all bisectors.
std::vector<RationalPoint> candidates_on(const Segment& segment,
                                         const std::vector<Point>& sensors) {
  const RationalPoint from = rational(segment.first), to = rational(segment.second);
  const RationalPoint way = minus(to, from);
  std::vector<RationalPoint> found{from, to};
  for (const Point& one : sensors) {
    for (const Point& other : sensors) {
      const RationalPoint a = minus(rational(one), from), b = minus(rational(other), from);
      const mpq_class scale = 2 * dot(way, minus(b, a));
      if (scale <= 0) continue;
      const mpq_class t = (dot(b, b) - dot(a, a)) / scale;
      if (t >= 0 && t <= 1) found.push_back({from.x + t * way.x, from.y + t * way.y});
    }
  }
  return found;
}

// All circumcentres, and what there is on the edges of the triangles.
std::vector<RationalPoint> candidates_in(const Mesh& mesh, std::span<const Region> region,
                                         const std::vector<Point>& sensors) {
  std::vector<Triangle> inside;
  for (IdValue value = 0; value < mesh.triangle_count(); ++value) {
    const Triangle triangle = mesh.triangle(TriangleId{value});
    if (!triangle.is_ghost() && region[value] == Region::inside) inside.push_back(triangle);
  }
  std::vector<RationalPoint> found;
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    for (std::size_t j = i + 1; j < sensors.size(); ++j) {
      for (std::size_t k = j + 1; k < sensors.size(); ++k) {
        const RationalPoint a = rational(sensors[i]);
        const RationalPoint b = minus(rational(sensors[j]), a), c = minus(rational(sensors[k]), a);
        const mpq_class scale = 2 * cross(b, c);
        if (scale == 0) continue;
        const RationalPoint centre{a.x + (dot(b, b) * c.y - dot(c, c) * b.y) / scale,
                                   a.y + (dot(c, c) * b.x - dot(b, b) * c.x) / scale};
        if (std::any_of(inside.begin(), inside.end(),
                        [&](const Triangle& t) { return is_in(mesh, t, centre); })) {
          found.push_back(centre);
        }
      }
    }
  }
  for (const Triangle& triangle : inside) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto more = candidates_on(
          {mesh.point(triangle.corner[i]), mesh.point(triangle.corner[(i + 1) % 3])}, sensors);
      found.insert(found.end(), more.begin(), more.end());
    }
  }
  return found;
}

// Prim's rule.
mpz_class least_range_squared(const std::vector<Point>& points) {
  std::vector<mpz_class> nearest(points.size(), mpz_class(-1));
  std::vector<bool> taken(points.size(), false);
  mpz_class least = 0;
  for (std::size_t step = 0, at = 0; step < points.size(); ++step) {
    taken[at] = true;
    std::size_t next = points.size();
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (taken[i]) continue;
      const mpz_class length = squared(rational(points[at]), rational(points[i])).get_num();
      if (nearest[i] < 0 || length < nearest[i]) nearest[i] = length;
      if (next == points.size() || nearest[i] < nearest[next]) next = i;
    }
    if (next == points.size()) break;
    least = std::max(least, nearest[next]);
    at = next;
  }
  return least;
}

std::uint32_t parts_at(const std::vector<Point>& points, std::uint32_t range) {
  std::vector<std::size_t> part(points.size());
  std::iota(part.begin(), part.end(), std::size_t{0});
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (squared(rational(points[i]), rational(points[j])) > squared_range(range)) continue;
      const std::size_t from = part[i], to = part[j];
      std::replace(part.begin(), part.end(), from, to);
    }
  }
  std::sort(part.begin(), part.end());
  return static_cast<std::uint32_t>(std::unique(part.begin(), part.end()) - part.begin());
}

std::vector<VertexId> chain_of(const Mesh& mesh, FeatureId feature) {
  std::vector<VertexId> chain(mesh.chain(feature, {}));
  chain.resize(mesh.chain(feature, chain));
  return chain;
}

}  // namespace etcm::test
