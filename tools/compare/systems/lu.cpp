// Lu, Wu, Zhou, reconstructed: the full text is not to be had, and the ETCM paper tells what came
// out but not how. Of the rules that were tried the first one here fits what it tells: two equal
// parts for every three triangles that the missing subsegment crosses, and again on what is still
// missing. The others are kept to be run.
#include <algorithm>
#include <cmath>
#include <limits>

#include "compare/systems/crossed.h"
#include "compare/systems/system.h"

namespace etcm::compare {
namespace {

using internal::Edge;
using Places = std::vector<Parameter>;

// The place of `part` of `parts` equal parts, rounded to the nearest parameter and between two to
// the even one: the same place from whichever end it is counted.
Parameter place_of_part(const MissingSubsegment& missing, std::int64_t part,
                        std::int64_t parts) noexcept {
  const std::int64_t scaled = (std::int64_t{missing.tail} - missing.head) * part;
  const std::int64_t below = missing.head + scaled / parts, twice_rest = scaled % parts * 2;
  const bool is_up = twice_rest > parts || (twice_rest == parts && below % 2 != 0);
  return static_cast<Parameter>(below + is_up);
}

void split_evenly(const MissingSubsegment& missing, std::int64_t parts, Places& places) {
  for (std::int64_t part = 1; part < parts; ++part) {
    places.push_back(place_of_part(missing, part, parts));
  }
}

void two_for_three_crossed(const MissingSubsegment& missing, Places& places) {
  split_evenly(missing, std::max(2u, 2 * crossed_triangle_count(missing) / 3), places);
}

void one_for_two_crossed(const MissingSubsegment& missing, Places& places) {
  split_evenly(missing, crossed_triangle_count(missing) / 2 + 1, places);
}

void as_many_as_crossed(const MissingSubsegment& missing, Places& places) {
  split_evenly(missing, crossed_triangle_count(missing), places);
}

// Parts about as long as the edges that the subsegment crosses.
void at_local_spacing(const MissingSubsegment& missing, Places& places) {
  const internal::MeshState& m = *missing.mesh;
  double sum = 0, count = 0;
  for_each_crossed(missing, [&](Edge e) {
    sum += distance(m.at(m.topology.origin(e)), m.at(m.topology.target(e)));
    ++count;
  });
  const double parts = distance(missing.at(missing.head), missing.at(missing.tail)) * count / sum;
  split_evenly(missing, std::max<std::int64_t>(std::llround(parts), 2), places);
}

// The middle of what the circle of neither end reaches; of the overlap, where they overlap.
void between_the_circles(const MissingSubsegment& missing, Places& places) {
  const SplitSite site = missing.site();
  places.push_back(middle_of(site.feasible_head, site.feasible_tail));
}

// The same, but of the subsegment, where the circles overlap.
void between_or_middle(const MissingSubsegment& missing, Places& places) {
  const SplitSite site = missing.site();
  places.push_back(site.feasible_head < site.feasible_tail
                       ? middle_of(site.feasible_head, site.feasible_tail)
                       : middle_of(missing.head, missing.tail));
}

// The foot of the perpendicular from the nearest vertex of the edges that the subsegment crosses.
void at_nearest_foot(const MissingSubsegment& missing, Places& places) {
  const internal::MeshState& m = *missing.mesh;
  double least = std::numeric_limits<double>::infinity();
  for_each_crossed(missing, [&](Edge e) {
    for (const VertexId v : {m.topology.origin(e), m.topology.target(e)}) {
      const double t = foot_of(missing, m.at(v));
      if (t <= missing.head + 1.0 || t >= missing.tail - 1.0) continue;
      const auto place = static_cast<Parameter>(std::nearbyint(t));
      const double height = distance(m.at(v), missing.at(place));
      if (height >= least) continue;
      least = height;
      places.assign(1, place);
    }
  });
  if (places.empty()) split_in_the_middle(missing, places);
}

// The one crossing that is nearest to the middle.
void at_middle_crossing(const MissingSubsegment& missing, Places& places) {
  const double middle = (static_cast<double>(missing.head) + missing.tail) / 2;
  double best = missing.head;
  for_each_crossed(missing, [&](Edge e) {
    const double t = crossing_of(missing, e);
    if (std::abs(t - middle) < std::abs(best - middle)) best = t;
  });
  add_if_inside(missing, best, places);
  if (places.empty()) split_in_the_middle(missing, places);
}

// Of 31 places, those that finish an end left aside where there are others, the furthest from all
// vertices around.
void furthest_from_vertices(const MissingSubsegment& missing, Places& places) {
  constexpr int parts = 32;
  const internal::MeshState& m = *missing.mesh;
  const SplitSite site = missing.site();
  const Parameter low = std::min(site.feasible_head, site.feasible_tail);
  const Parameter high = std::max(site.feasible_head, site.feasible_tail);
  double furthest = 0;
  for (int part = 1; part < parts; ++part) {
    const Parameter t = place_of_part(missing, part, parts);
    if (t < low || t > high) continue;
    const Point at = missing.at(t);
    double nearest =
        std::min(distance(at, missing.at(missing.head)), distance(at, missing.at(missing.tail)));
    for_each_crossed(missing, [&](Edge e) {
      for (const VertexId v : {m.topology.origin(e), m.topology.target(e)}) {
        nearest = std::min(nearest, distance(at, m.at(v)));
      }
    });
    if (nearest <= furthest) continue;
    furthest = nearest;
    places.assign(1, t);
  }
  if (places.empty()) split_in_the_middle(missing, places);
}

}  // namespace

Attempt run_lu(const inputs::Graph& graph, Depth depth) {
  return run_rival(graph, {.split = two_for_three_crossed}, depth);
}
Attempt run_lu_half(const inputs::Graph& graph, Depth depth) {
  return run_rival(graph, {.split = one_for_two_crossed}, depth);
}
Attempt run_lu_each(const inputs::Graph& graph, Depth depth) {
  return run_rival(graph, {.split = as_many_as_crossed}, depth);
}
Attempt run_lu_spacing(const inputs::Graph& graph, Depth depth) {
  return run_rival(graph, {.split = at_local_spacing}, depth);
}
Attempt run_lu_gap(const inputs::Graph& graph, Depth depth) {
  return run_rival(graph, {.split = between_the_circles}, depth);
}
Attempt run_lu_gap_middle(const inputs::Graph& graph, Depth depth) {
  return run_rival(graph, {.split = between_or_middle}, depth);
}
Attempt run_lu_foot(const inputs::Graph& graph, Depth depth) {
  return run_rival(graph, {.split = at_nearest_foot}, depth);
}
Attempt run_lu_crossing(const inputs::Graph& graph, Depth depth) {
  return run_rival(graph, {.split = at_middle_crossing}, depth);
}
Attempt run_lu_far(const inputs::Graph& graph, Depth depth) {
  return run_rival(graph, {.split = furthest_from_vertices}, depth);
}

}  // namespace etcm::compare
