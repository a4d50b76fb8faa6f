#include "compare/systems/crossed.h"

#include <cmath>

namespace etcm::compare {
namespace {

using internal::Edge;

struct Vector {
  double x;
  double y;
};

Vector from_to(const Point& a, const Point& b) noexcept {
  return {static_cast<double>(b.x - a.x), static_cast<double>(b.y - a.y)};
}

double cross(Vector a, Vector b) noexcept { return a.x * b.y - a.y * b.x; }
double dot(Vector a, Vector b) noexcept { return a.x * b.x + a.y * b.y; }

}  // namespace

unsigned crossed_triangle_count(const MissingSubsegment& missing) {
  unsigned count = 1;
  for_each_crossed(missing, [&](Edge) { ++count; });
  return count;
}

double crossing_of(const MissingSubsegment& missing, Edge edge) noexcept {
  const internal::MeshState& m = *missing.mesh;
  const Point from = missing.at(0);
  const Point& a = m.at(m.topology.origin(edge));
  const Vector along = from_to(a, m.at(m.topology.target(edge)));
  return cross(from_to(from, a), along) / cross(from_to(from, missing.at(parameter_end)), along) *
         parameter_end;
}

double foot_of(const MissingSubsegment& missing, const Point& point) noexcept {
  const Point from = missing.at(0);
  const Vector feature = from_to(from, missing.at(parameter_end));
  return dot(from_to(from, point), feature) / dot(feature, feature) * parameter_end;
}

void add_if_inside(const MissingSubsegment& missing, double t, std::vector<Parameter>& places) {
  const double rounded = std::nearbyint(t);
  if (missing.head < rounded && rounded < missing.tail) {
    places.push_back(static_cast<Parameter>(rounded));
  }
}

double distance(const Point& a, const Point& b) noexcept {
  const Vector between = from_to(a, b);
  return std::hypot(between.x, between.y);
}

}  // namespace etcm::compare
