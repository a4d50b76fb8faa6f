// Tsai: a point on every crossing of the missing piece with the edges of the mesh as it stands, and
// again on what is still missing. On the grid the crossing is the nearest place on the feature.
#include <algorithm>
#include <vector>

#include "compare/rival.h"
#include "compare/system.h"
#include "etcm/predicates.h"

namespace etcm::compare {
namespace {

using namespace internal;

// The parameter at which the section's line meets the line through an edge. In double: it is a
// choice of place, and every place on the feature is exact.
Parameter crossing(const MeshState& m, SectionId s, Edge e) noexcept {
  const Point& from = m.at(m.section(s).from);
  const Point& to = m.at(m.section(s).to);
  const Point& a = m.at(m.topology.origin(e));
  const Point& b = m.at(m.topology.target(e));
  const auto cross = [](double x1, double y1, double x2, double y2) { return x1 * y2 - y1 * x2; };
  const double ex = static_cast<double>(b.x - a.x), ey = static_cast<double>(b.y - a.y);
  const double above =
      cross(static_cast<double>(a.x - from.x), static_cast<double>(a.y - from.y), ex, ey);
  const double below =
      cross(static_cast<double>(to.x - from.x), static_cast<double>(to.y - from.y), ex, ey);
  const double t = above / below * parameter_end;
  return static_cast<Parameter>(std::clamp(t + 0.5, 0.0, static_cast<double>(parameter_end)));
}

// All crossings inside the piece, each place once.
std::vector<Parameter> crossings(const MeshState& m, SectionId s, const Stretch& piece) {
  const auto [head, tail] = ends_of_piece(m, s, piece.head, piece.tail);
  std::vector<Parameter> found;
  Edge e = piece.head_edge;
  while (true) {
    const Parameter t = crossing(m, s, e);
    if (head < t && t < tail) found.push_back(t);
    const Edge beyond = m.topology.twin(e);
    if (beyond == piece.tail_edge) break;
    const int side = orient2d(m.at(piece.head), m.at(piece.tail), m.at(m.topology.apex(beyond)));
    e = side > 0 ? Topology::next(beyond) : Topology::prev(beyond);
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  // Beside a crossing that rounds onto an end there is still the middle.
  if (found.empty() && tail - head > 1) found.push_back(head + (tail - head) / 2);
  return found;
}

Status conform_section(MeshState& m, SectionId s) {
  const VertexId end = m.section(s).to;
  VertexId v = m.section(s).from;
  while (v != end) {
    const Stretch piece = march(m, v, end);
    if (!can_be_edge(m, piece)) {
      const std::vector<Parameter> added = crossings(m, s, piece);
      if (added.empty()) return Status::grid_exhausted;
      for (const Parameter t : added) {
        const Status status = insert_on_section(m, s, t, m.topology.edge_at(v));
        if (status != Status::ok) return status;
      }
      continue;
    }
    settle_piece(m, piece);
    v = piece.tail;
  }
  return Status::ok;
}

Status conform_at_crossings(MeshState& m) noexcept {
  for (SectionId s = pop_dirty(m); !s.is_none(); s = pop_dirty(m)) {
    const Status status = conform_section(m, s);
    if (status != Status::ok) return status;
  }
  return Status::ok;
}

}  // namespace

Attempt run_tsai(const inputs::Graph& graph, Depth depth) {
  return run_rival(graph, {.policy = split_middle, .conform = conform_at_crossings}, depth);
}

}  // namespace etcm::compare
