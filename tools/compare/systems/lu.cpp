// Lu, Wu, Zhou, reconstructed: the full text is not to be had, and the ETCM paper tells what came
// out but not how. Of the rules that were tried the first one here fits what it tells: two equal
// parts for every three triangles that the missing piece crosses, and again on what is still
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
Parameter place_of_part(const MissingPiece& piece, std::int64_t part, std::int64_t parts) noexcept {
  const std::int64_t scaled = (std::int64_t{piece.tail} - piece.head) * part;
  const std::int64_t below = piece.head + scaled / parts, twice_rest = scaled % parts * 2;
  const bool is_up = twice_rest > parts || (twice_rest == parts && below % 2 != 0);
  return static_cast<Parameter>(below + is_up);
}

void split_evenly(const MissingPiece& piece, std::int64_t parts, Places& places) {
  for (std::int64_t part = 1; part < parts; ++part) {
    places.push_back(place_of_part(piece, part, parts));
  }
}

void two_for_three_crossed(const MissingPiece& piece, Places& places) {
  split_evenly(piece, std::max(2u, 2 * crossed_triangle_count(piece) / 3), places);
}

void one_for_two_crossed(const MissingPiece& piece, Places& places) {
  split_evenly(piece, crossed_triangle_count(piece) / 2 + 1, places);
}

void as_many_as_crossed(const MissingPiece& piece, Places& places) {
  split_evenly(piece, crossed_triangle_count(piece), places);
}

// Parts about as long as the edges that the piece crosses.
void at_local_spacing(const MissingPiece& piece, Places& places) {
  const internal::MeshState& m = *piece.mesh;
  double sum = 0, count = 0;
  for_each_crossed(piece, [&](Edge e) {
    sum += distance(m.at(m.topology.origin(e)), m.at(m.topology.target(e)));
    ++count;
  });
  const double parts = distance(piece.at(piece.head), piece.at(piece.tail)) * count / sum;
  split_evenly(piece, std::max<std::int64_t>(std::llround(parts), 2), places);
}

// The middle of what the circle of neither end reaches; of the overlap, where they overlap.
void between_the_circles(const MissingPiece& piece, Places& places) {
  const SplitSite site = piece.site();
  places.push_back(middle_of(site.feasible_head, site.feasible_tail));
}

// The same, but of the piece, where the circles overlap.
void between_or_middle(const MissingPiece& piece, Places& places) {
  const SplitSite site = piece.site();
  places.push_back(site.feasible_head < site.feasible_tail
                       ? middle_of(site.feasible_head, site.feasible_tail)
                       : middle_of(piece.head, piece.tail));
}

// The foot of the perpendicular from the nearest vertex of the edges that the piece crosses.
void at_nearest_foot(const MissingPiece& piece, Places& places) {
  const internal::MeshState& m = *piece.mesh;
  double least = std::numeric_limits<double>::infinity();
  for_each_crossed(piece, [&](Edge e) {
    for (const VertexId v : {m.topology.origin(e), m.topology.target(e)}) {
      const double t = foot_of(piece, m.at(v));
      if (t <= piece.head + 1.0 || t >= piece.tail - 1.0) continue;
      const auto place = static_cast<Parameter>(std::nearbyint(t));
      const double height = distance(m.at(v), piece.at(place));
      if (height >= least) continue;
      least = height;
      places.assign(1, place);
    }
  });
  if (places.empty()) split_in_the_middle(piece, places);
}

// The one crossing that is nearest to the middle.
void at_middle_crossing(const MissingPiece& piece, Places& places) {
  const double middle = (static_cast<double>(piece.head) + piece.tail) / 2;
  double best = piece.head;
  for_each_crossed(piece, [&](Edge e) {
    const double t = crossing_of(piece, e);
    if (std::abs(t - middle) < std::abs(best - middle)) best = t;
  });
  add_if_inside(piece, best, places);
  if (places.empty()) split_in_the_middle(piece, places);
}

// Of 31 places, those that finish an end left aside where there are others, the furthest from all
// vertices around.
void furthest_from_vertices(const MissingPiece& piece, Places& places) {
  constexpr int parts = 32;
  const internal::MeshState& m = *piece.mesh;
  const SplitSite site = piece.site();
  const Parameter low = std::min(site.feasible_head, site.feasible_tail);
  const Parameter high = std::max(site.feasible_head, site.feasible_tail);
  double furthest = 0;
  for (int part = 1; part < parts; ++part) {
    const Parameter t = place_of_part(piece, part, parts);
    if (t < low || t > high) continue;
    const Point at = piece.at(t);
    double nearest =
        std::min(distance(at, piece.at(piece.head)), distance(at, piece.at(piece.tail)));
    for_each_crossed(piece, [&](Edge e) {
      for (const VertexId v : {m.topology.origin(e), m.topology.target(e)}) {
        nearest = std::min(nearest, distance(at, m.at(v)));
      }
    });
    if (nearest <= furthest) continue;
    furthest = nearest;
    places.assign(1, t);
  }
  if (places.empty()) split_in_the_middle(piece, places);
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
