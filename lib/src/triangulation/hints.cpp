// Where to start a walk: a coarse grid over the nodes that knows one node for each cell, so that
// finding a place costs the same in a small mesh and in a large one. Each axis is cut into eighths
// of the nodes first, so that a few that stand far away take nothing from the others. When as many
// have come again, it is laid anew. Only hints: what they say shortens walks and never shows in a
// mesh.
#include "triangulation/hints.h"

#include "base/begin_array.h"
#include "triangulation/mesh_state.h"

namespace etcm::internal {
namespace {

// As many of the nodes say where the others are.
constexpr std::size_t sample_most = 128;
// A node that comes outside of the grid tells of more like it.
constexpr std::uint32_t cost_outside = 8;

std::size_t cell_count(const Hints& h) noexcept { return std::size_t{1} << (2 * h.side_bits); }

std::int32_t unit_of(std::int64_t coordinate) noexcept {
  return static_cast<std::int32_t>(coordinate >> subunit_bits);
}

// Each eighth of an axis is cut into this many columns, as a power of two.
int step_bits(const Hints& h) noexcept { return h.side_bits < 3 ? 0 : h.side_bits - 3; }

// The column, or row, of a coordinate. What is outside belongs to the first or the last. Without
// branches: half of them would be guessed wrong.
std::size_t place_on(const Hints& h, const HintAxis& axis, std::int32_t at) noexcept {
  unsigned eighth = at >= axis.knot[4] ? 4u : 0u;
  eighth += at >= axis.knot[eighth + 2] ? 2u : 0u;
  eighth += at >= axis.knot[eighth + 1] ? 1u : 0u;
  const auto last = static_cast<float>((1 << step_bits(h)) - 1);
  const float steps = static_cast<float>(at - axis.knot[eighth]) * axis.steps_per_unit[eighth];
  const float below = steps < last ? steps : last;
  const auto step = static_cast<std::size_t>(static_cast<std::int32_t>(below > 0 ? below : 0));
  return ((std::size_t{eighth} << step_bits(h)) | step) >> (3 + step_bits(h) - h.side_bits);
}

VertexId& cell_of(const MeshState& m, const Point& p) noexcept {
  const Hints& h = m.hints;
  return m
      .hint_cells[(place_on(h, h.y, unit_of(p.y)) << h.side_bits) | place_on(h, h.x, unit_of(p.x))];
}

bool is_outside(const HintAxis& axis, std::int32_t at) noexcept {
  return at < axis.knot[0] || at > axis.knot[8];
}

// Visits every k-th node, `most` at most and about half as many at least, or all.
template <class Visit>
void for_some_nodes(MeshState& m, std::size_t most, Visit visit) noexcept {
  const auto stride = static_cast<std::uint32_t>(m.node_count / (most + 1) + 1);
  std::uint32_t wait = stride;
  for (IdValue i = 1; i < m.vertex_end; ++i) {
    m.work.pass_entry(i);
    if (m.owners[i].role() != Role::node || --wait != 0) continue;
    wait = stride;
    visit(VertexId{i});
  }
}

// Cuts an axis where a sample says that an eighth of the nodes lies between, without the outermost
// of the sample. The sample lies in the memory of the cells.
void cut(MeshState& m, HintAxis& axis, std::int64_t Point::*coordinate) noexcept {
  const Hints& h = m.hints;
  // Half of what there is room for with ids of 16 bits: the same walks whatever the width.
  std::size_t most = cell_count(h) / 4;
  if (most > sample_most) most = sample_most;
  auto* const sample = begin_array<std::int32_t>(m.hint_cells, most);
  std::size_t count = 0;
  for_some_nodes(m, most, [&](VertexId v) noexcept {
    const std::int32_t at = unit_of(m.at(v).*coordinate);
    m.work.pass(count / 8);  // it comes before as many as that at the most, in eight moves a unit
    std::size_t k = count++;
    for (; k != 0 && at < sample[k - 1]; --k) sample[k] = sample[k - 1];
    sample[k] = at;
  });
  const std::size_t trimmed = count / 64;
  for (std::size_t i = 0; i <= 8; ++i) {
    axis.knot[i] = count == 0 ? 0 : sample[trimmed + i * (count - 1 - 2 * trimmed) / 8];
  }
  for (std::size_t i = 0; i < 8; ++i) {
    const std::int32_t width = axis.knot[i + 1] - axis.knot[i];
    axis.steps_per_unit[i] =
        width == 0 ? 0 : static_cast<float>(1 << step_bits(h)) / static_cast<float>(width);
  }
}

}  // namespace

void spread_hints(MeshState& m) noexcept {
  Hints& h = m.hints;
  // Two nodes a cell at least, or many would be empty.
  h.side_bits = 0;
  while (h.side_bits < h.side_bits_most &&
         (std::uint64_t{8} << (2 * h.side_bits)) <= m.node_count) {
    ++h.side_bits;
  }
  cut(m, h.x, &Point::x);
  cut(m, h.y, &Point::y);
  h.patience = 2 * m.node_count + 16;
  for (std::size_t i = 0; i < cell_count(h); ++i) {
    m.work.pass_entry(i);
    m.hint_cells[i] = VertexId::none();
  }
  // A few nodes for each cell are enough.
  for_some_nodes(m, 4 * cell_count(h), [&](VertexId v) noexcept { cell_of(m, m.at(v)) = v; });
}

void add_hint(MeshState& m, VertexId node) noexcept {
  Hints& h = m.hints;
  const Point& p = m.at(node);
  const bool outside = is_outside(h.x, unit_of(p.x)) || is_outside(h.y, unit_of(p.y));
  const std::uint32_t cost = outside ? cost_outside : 1;
  if (m.node_count < 2 || h.patience < cost) spread_hints(m);
  h.patience -= cost;
  cell_of(m, p) = node;
}

void remove_hint(MeshState& m, VertexId node) noexcept {
  VertexId& cell = cell_of(m, m.at(node));
  if (cell != node) return;
  // Another node of the same cell, if one is near: a node is in no cell but its own, so that it can
  // be forgotten as well.
  cell = VertexId::none();
  if (m.topology.triangle_count() == 0) return;
  Spokes spokes(m.topology, node);
  do {
    const VertexId v = spokes.target();
    if (v != infinite_vertex && m.owner(v).role() == Role::node && &cell_of(m, m.at(v)) == &cell) {
      cell = v;
      return;
    }
  } while (spokes.turn());
}

Edge edge_near(const MeshState& m, const Point& p) noexcept {
  const Hints& h = m.hints;
  if (m.topology.triangle_count() == 0 || m.node_count < 2) return m.walk_start;
  const std::size_t side = std::size_t{1} << h.side_bits;
  const std::size_t row = place_on(h, h.y, unit_of(p.y)), column = place_on(h, h.x, unit_of(p.x));
  // Where the cell is empty the next one in its row or its column will do.
  for (std::size_t away = 0; away < side; ++away) {
    const std::size_t rows[] = {row, row, row + away, row - away};
    const std::size_t columns[] = {column + away, column - away, column, column};
    for (unsigned i = 0; i < 4; ++i) {
      if (rows[i] >= side || columns[i] >= side) continue;
      const VertexId v = m.hint_cells[(rows[i] << h.side_bits) | columns[i]];
      if (!v.is_none()) return m.topology.edge_at(v);
    }
  }
  return m.walk_start;
}

}  // namespace etcm::internal
