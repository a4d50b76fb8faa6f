// What a missing subsegment crosses: the edges between the triangles that it runs through.
#pragma once

#include "compare/systems/rival.h"
#include "etcm/predicates.h"

namespace etcm::compare {

// Calls look(edge) for each edge that the subsegment crosses, from head to tail. The edge runs from
// the right of the subsegment to its left, and its apex lies towards the head.
template <class Look>
void for_each_crossed(const MissingSubsegment& missing, Look look) {
  const internal::MeshState& m = *missing.mesh;
  const Point &from = m.at(missing.subsegment.head), &to = m.at(missing.subsegment.tail);
  for (internal::Edge e = missing.subsegment.head_edge;;) {
    look(e);
    const internal::Edge beyond = m.topology.twin(e);
    if (beyond == missing.subsegment.tail_edge) return;
    const int side = orient2d(from, to, m.at(m.topology.apex(beyond)));
    e = side > 0 ? internal::Topology::next(beyond) : internal::Topology::prev(beyond);
  }
}

// At least two.
unsigned crossed_triangle_count(const MissingSubsegment& missing);

// Where the feature meets the line through an edge, in parameters. In double: it is a choice of
// place, and every place on the feature is exact.
double crossing_of(const MissingSubsegment& missing, internal::Edge edge) noexcept;

// Where the perpendicular from a point meets the feature, in parameters.
double foot_of(const MissingSubsegment& missing, const Point& point) noexcept;

// Adds the place of a parameter in double, unless it rounds onto an end of the subsegment.
void add_if_inside(const MissingSubsegment& missing, double t, std::vector<Parameter>& places);

double distance(const Point& a, const Point& b) noexcept;

}  // namespace etcm::compare
