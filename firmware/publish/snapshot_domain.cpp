#include "firmware/publish/snapshot_domain.h"

#include <algorithm>
#include <span>

#include "etcm/predicates.h"

namespace etcm::firmware {

SnapshotDomain::SnapshotDomain(const MeshConfig& config) {
  const std::size_t edges = std::size_t{neighbours_per_vertex_max} * config.vertices_max;
  left_.reserve(edges);
  twin_.reserve(edges);
  next_.reserve(edges);
  waiting_.reserve(edges);
}

void SnapshotDomain::label(const Snapshot& snapshot) {
  left_.assign(snapshot.neighbours.size(), Left::inside);
  link_edges(snapshot);
  flood_from_hull(snapshot);
  if (!leaves_a_node_outside(snapshot)) return;
  std::replace(left_.begin(), left_.end(), Left::outside, Left::inside);
}

void SnapshotDomain::link_edges(const Snapshot& snapshot) {
  twin_.assign(snapshot.neighbours.size(), 0);
  next_.assign(snapshot.neighbours.size(), 0);
  for (std::uint32_t row = 0; row < snapshot.vertices.size(); ++row) {
    const SnapshotVertex& vertex = snapshot.vertices[row];
    const std::span around = neighbours_of(snapshot, row);
    for (std::uint32_t i = 0; i < around.size(); ++i) {
      const std::uint32_t other = around[i].row;
      const std::uint32_t last = around[(i + 1) % around.size()].row;
      const std::uint32_t edge = vertex.first_neighbour + i;
      // Around a corner of the hull the turn past the outside is no left one.
      if (orient2d(vertex.point, snapshot.vertices[other].point, snapshot.vertices[last].point) <=
          0) {
        left_[edge] = Left::beyond_hull;
      }
      const std::span back = neighbours_of(snapshot, other);
      const auto found = std::find_if(
          back.begin(), back.end(), [row](const auto& neighbour) { return neighbour.row == row; });
      const auto at = static_cast<std::uint32_t>(found - back.begin());
      const auto degree = static_cast<std::uint32_t>(back.size());
      const std::uint32_t first = snapshot.vertices[other].first_neighbour;
      twin_[edge] = first + at;
      next_[edge] = first + (at + degree - 1) % degree;
    }
  }
}

void SnapshotDomain::mark_outside(std::uint32_t edge) {
  // The three sides of one triangle.
  for (std::uint32_t side = edge; left_[side] == Left::inside; side = next_[side]) {
    left_[side] = Left::outside;
    waiting_.push_back(side);
  }
}

void SnapshotDomain::flood_from_hull(const Snapshot& snapshot) {
  waiting_.clear();
  for (std::uint32_t edge = 0; edge < left_.size(); ++edge) {
    if (left_[edge] == Left::beyond_hull) waiting_.push_back(edge);
  }
  // Each edge waits at most once: it is marked when it is put in line.
  while (!waiting_.empty()) {
    const std::uint32_t edge = waiting_.back();
    waiting_.pop_back();
    if (!snapshot.neighbours[edge].constrained) mark_outside(twin_[edge]);
  }
}

// A node all around which is outside is on no closed feature and in none.
bool SnapshotDomain::leaves_a_node_outside(const Snapshot& snapshot) const {
  return std::any_of(snapshot.vertices.begin(), snapshot.vertices.end(), [&](const auto& vertex) {
    const std::span around = std::span(left_).subspan(vertex.first_neighbour, vertex.degree);
    return vertex.kind == VertexKind::node &&
           std::none_of(around.begin(), around.end(), [](Left l) { return l == Left::inside; });
  });
}

}  // namespace etcm::firmware
