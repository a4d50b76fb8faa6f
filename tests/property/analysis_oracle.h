// The questions of etcm/analysis.h answered by brute force, in rational numbers, from points and
// triangles alone. For small meshes.
#pragma once

#include <gmpxx.h>

#include <span>
#include <utility>
#include <vector>

#include "etcm/analysis.h"
#include "etcm/mesh.h"

namespace etcm::test {

struct RationalPoint {
  mpq_class x;
  mpq_class y;
};

using Segment = std::pair<Point, Point>;

RationalPoint rational(const Point& p);
mpq_class squared(const RationalPoint& a, const RationalPoint& b);
mpq_class squared_range(std::uint32_t units);
mpz_class integer(const SquaredLength& length);

std::vector<Point> points_of(const Mesh& mesh);

// The square of the distance to the nearest.
mpq_class squared_distance_to(const std::vector<Point>& sensors, const RationalPoint& place);

// Where the distance to the nearest sensor can be greatest on a segment, or on the domain: a
// superset of the places, all of them there.
std::vector<RationalPoint> candidates_on(const Segment& segment, const std::vector<Point>& sensors);
std::vector<RationalPoint> candidates_in(const Mesh& mesh, std::span<const Region> region,
                                         const std::vector<Point>& sensors);

// The square of the least range of radios that makes all vertices one network, and the number of
// parts at a given range, over all pairs.
mpz_class least_range_squared(const std::vector<Point>& points);
std::uint32_t parts_at(const std::vector<Point>& points, std::uint32_t range);

// The vertices of a feature from one end to the other.
std::vector<VertexId> chain_of(const Mesh& mesh, FeatureId feature);

}  // namespace etcm::test
