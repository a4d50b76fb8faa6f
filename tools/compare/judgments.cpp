#include "compare/judgments.h"

#include <algorithm>

#include "compare/systems/crossed.h"
#include "compare/systems/etcm_literal.h"

namespace etcm::compare {
namespace {

using namespace internal;

// Round the endpoint until the triangle is found that the piece enters; `all` of them there are.
struct Around {
  std::uint64_t until_found = 0;
  std::uint64_t all = 0;
};

Around look_around(const MissingPiece& piece) {
  const Topology& topo = piece.mesh->topology;
  Around around;
  const Edge first = topo.edge_at(piece.subsegment.head);
  Edge e = first;
  do {
    const IdValue triangle = Topology::triangle_of(e);
    if (!topo.is_ghost(triangle)) ++around.all;
    if (triangle == Topology::triangle_of(piece.subsegment.head_edge))
      around.until_found = around.all;
    e = topo.rotate_ccw(e);
  } while (e != first);
  return around;
}

// Of the two edges by which the piece may leave a triangle, the one that is asked first.
std::uint64_t judgments_onward(const MissingPiece& piece) {
  const Topology& topo = piece.mesh->topology;
  std::uint64_t judgments = 0;
  Edge entered{};
  for_each_crossed(piece, [&](Edge e) {
    if (!entered.is_none()) judgments += e == Topology::next(entered) ? 1 : 2;
    entered = topo.twin(e);
  });
  return judgments;
}

// The triangles along the piece before the one that holds the place.
std::uint64_t triangles_before(const MissingPiece& piece, Parameter place) {
  std::uint64_t count = 0;
  for_each_crossed(piece, [&](Edge e) { count += crossing_of(piece, e) < place; });
  return count;
}

}  // namespace

JudgmentTally& JudgmentTally::operator+=(const JudgmentTally& other) noexcept {
  pieces += other.pieces;
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
  const auto split = [&](const MissingPiece& piece, std::vector<Parameter>& places) {
    split_literally(piece, places);
    const std::uint64_t n = crossed_triangle_count(piece);
    const bool is_remainder =
        piece.segment == last_segment && (piece.head == last_place || piece.tail == last_place);
    if (!is_remainder) {
      const Around around = look_around(piece);
      ++tally.pieces;
      tally.crossed += n;
      tally.around += around.all;
      tally.intersections += around.until_found + judgments_onward(piece);
    }
    last_segment = piece.segment;
    last_place = places.front();
    ++tally.points;
    tally.searched += n;
    tally.containment += std::min(triangles_before(piece, last_place) + 1, n - 1);
  };
  run_rival(graph, {.split = split}, Depth::times);
  return tally;
}

}  // namespace etcm::compare
