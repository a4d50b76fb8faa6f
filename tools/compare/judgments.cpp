#include "compare/judgments.h"

#include <algorithm>

#include "compare/systems/crossed.h"
#include "compare/systems/etcm_literal.h"

namespace etcm::compare {
namespace {

using namespace internal;

// Round the endpoint until the triangle is found that the subsegment enters; `all` of them there
// are.
struct Around {
  std::uint64_t until_found = 0;
  std::uint64_t all = 0;
};

Around look_around(const MissingSubsegment& missing) {
  const Topology& topo = missing.mesh->topology;
  Around around;
  const Edge first = topo.edge_at(missing.subsegment.head);
  Edge e = first;
  do {
    const IdValue triangle = Topology::triangle_of(e);
    if (!topo.is_ghost(triangle)) ++around.all;
    if (triangle == Topology::triangle_of(missing.subsegment.head_edge))
      around.until_found = around.all;
    e = topo.rotate_ccw(e);
  } while (e != first);
  return around;
}

// Of the two edges by which the subsegment may leave a triangle, the one that is asked first.
std::uint64_t judgments_onward(const MissingSubsegment& missing) {
  const Topology& topo = missing.mesh->topology;
  std::uint64_t judgments = 0;
  Edge entered{};
  for_each_crossed(missing, [&](Edge e) {
    if (!entered.is_none()) judgments += e == Topology::next(entered) ? 1 : 2;
    entered = topo.twin(e);
  });
  return judgments;
}

// The triangles along the subsegment before the one that holds the place.
std::uint64_t triangles_before(const MissingSubsegment& missing, Parameter place) {
  std::uint64_t count = 0;
  for_each_crossed(missing, [&](Edge e) { count += crossing_of(missing, e) < place; });
  return count;
}

}  // namespace

JudgmentTally& JudgmentTally::operator+=(const JudgmentTally& other) noexcept {
  subsegments += other.subsegments;
  crossed += other.crossed;
  around += other.around;
  intersections += other.intersections;
  points += other.points;
  searched += other.searched;
  containment += other.containment;
  return *this;
}

JudgmentTally count_judgments(const inputs::Graph& graph) {
  JudgmentTally tally;
  // A remainder is known already: it ends where the last point came.
  SegmentId last_segment = SegmentId::none();
  Parameter last_place = 0;
  const auto split = [&](const MissingSubsegment& missing, std::vector<Parameter>& places) {
    split_literally(missing, places);
    const std::uint64_t n = crossed_triangle_count(missing);
    const bool is_remainder = missing.segment == last_segment &&
                              (missing.head == last_place || missing.tail == last_place);
    if (!is_remainder) {
      const Around around = look_around(missing);
      ++tally.subsegments;
      tally.crossed += n;
      tally.around += around.all;
      tally.intersections += around.until_found + judgments_onward(missing);
    }
    last_segment = missing.segment;
    last_place = places.front();
    ++tally.points;
    tally.searched += n;
    tally.containment += std::min(triangles_before(missing, last_place) + 1, n - 1);
  };
  run_rival(graph, {.split = split}, Depth::times);
  return tally;
}

}  // namespace etcm::compare
