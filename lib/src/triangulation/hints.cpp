// Where to start a walk: a coarse grid over the nodes that knows one node for each cell, so that
// finding a place costs the same in a small mesh and in a large one. Only hints: what they say
// shortens walks and never shows in a mesh.
#include "triangulation/hints.h"

#include "triangulation/mesh_state.h"

namespace etcm::internal {
namespace {

struct Bounds {
  Point low;
  Point high;
  void include(const Point& p) noexcept {
    if (p.x < low.x) low.x = p.x;
    if (p.y < low.y) low.y = p.y;
    if (p.x > high.x) high.x = p.x;
    if (p.y > high.y) high.y = p.y;
  }
};

std::size_t cell_count(const Hints& h) noexcept { return std::size_t{1} << (2 * h.side_bits); }

bool covers(const Hints& h, const Point& p) noexcept {
  const std::int64_t limit = std::int64_t{1} << (h.cell_bits + h.side_bits);
  return p.x >= h.low.x && p.y >= h.low.y && p.x - h.low.x < limit && p.y - h.low.y < limit;
}

VertexId& cell_of(const Hints& h, const Point& p) noexcept {
  const auto column = static_cast<std::size_t>((p.x - h.low.x) >> h.cell_bits);
  const auto row = static_cast<std::size_t>((p.y - h.low.y) >> h.cell_bits);
  return h.nodes[(row << h.side_bits) | column];
}

double distance2(const Point& a, const Point& b) noexcept {
  const auto dx = static_cast<double>(a.x - b.x), dy = static_cast<double>(a.y - b.y);
  return dx * dx + dy * dy;
}

}  // namespace

void spread_hints(MeshState& m, const Point* also) noexcept {
  Hints& h = m.hints;
  Bounds bounds{};
  bool is_first = true;
  const auto include = [&](const Point& p) {
    if (is_first) bounds = {p, p};
    is_first = false;
    bounds.include(p);
  };
  for (IdValue i = 1; i < m.vertex_end; ++i) {
    if (m.owners[i].role() == Role::node) include(m.points[i]);
  }
  if (also != nullptr) include(*also);
  // Twice the extent, with what is there in the middle: a growing network seldom leaves it, and
  // every time it does, it has doubled.
  const std::int64_t width = bounds.high.x - bounds.low.x, height = bounds.high.y - bounds.low.y;
  const std::int64_t extent = width > height ? width : height;
  h.cell_bits = 0;
  while ((std::int64_t{1} << (h.cell_bits + h.side_bits)) <= 2 * extent) ++h.cell_bits;
  const std::int64_t margin = ((std::int64_t{1} << (h.cell_bits + h.side_bits)) - extent) / 2;
  h.low = {bounds.low.x - margin, bounds.low.y - margin};
  for (std::size_t i = 0; i < cell_count(h); ++i) h.nodes[i] = VertexId::none();
  for (IdValue i = 1; i < m.vertex_end; ++i) {
    if (m.owners[i].role() == Role::node) cell_of(h, m.points[i]) = VertexId{i};
  }
}

void add_hint(MeshState& m, VertexId node) noexcept {
  if (m.node_count < 2 || !covers(m.hints, m.at(node))) {
    spread_hints(m, &m.at(node));
  }
  cell_of(m.hints, m.at(node)) = node;
}

void remove_hint(MeshState& m, VertexId node) noexcept {
  VertexId& cell = cell_of(m.hints, m.at(node));
  if (cell != node) return;
  // Another node of the same cell, if one is near: a node is in no cell but its own, so that it can
  // be forgotten as well.
  cell = VertexId::none();
  if (m.topology.triangle_count() == 0) return;
  Spokes spokes(m.topology, node);
  do {
    const VertexId v = spokes.target();
    if (v != infinite_vertex && m.owner(v).role() == Role::node &&
        &cell_of(m.hints, m.at(v)) == &cell) {
      cell = v;
      return;
    }
  } while (spokes.turn());
}

Edge edge_near(const MeshState& m, const Point& p) noexcept {
  const Hints& h = m.hints;
  if (m.topology.triangle_count() == 0 || m.node_count < 2) return m.walk_start;
  VertexId best = covers(h, p) ? cell_of(h, p) : VertexId::none();
  if (best.is_none()) {
    // An empty cell: the nearest of a few other cells, spread over the grid, will do.
    const std::size_t cells = cell_count(h);
    const std::size_t stride = cells / 16 + 1;
    for (std::size_t i = 0; i < cells; i += stride) {
      const VertexId v = h.nodes[i];
      if (v.is_none()) continue;
      if (best.is_none() || distance2(m.at(v), p) < distance2(m.at(best), p)) best = v;
    }
    if (best.is_none()) return m.walk_start;
  }
  return m.topology.edge_at(best);
}

}  // namespace etcm::internal
