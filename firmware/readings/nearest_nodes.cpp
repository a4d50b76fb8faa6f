#include "firmware/readings/nearest_nodes.h"

#include <algorithm>
#include <utility>

namespace etcm::firmware {

namespace {

// Edges looked at, of a node and of a Steiner vertex.
constexpr std::size_t node_looks_max = 64;
constexpr std::size_t steiner_looks_max = 16;

double units_of(std::int64_t subunits) {
  return static_cast<double>(subunits) / static_cast<double>(subunits_per_unit);
}

bool is_nearer(const NearNode& a, const NearNode& b) {
  const double to_a = a.x * a.x + a.y * a.y;
  const double to_b = b.x * b.x + b.y * b.y;
  return to_a != to_b ? to_a < to_b : a.row < b.row;
}

// Calls look(row) for so many neighbours of a vertex, evenly spread around it.
template <class Look>
void look_around(const Snapshot& snapshot, std::uint32_t row, std::size_t looks_max, Look look) {
  const auto neighbours = neighbours_of(snapshot, row);
  const std::size_t stride = (neighbours.size() + looks_max - 1) / looks_max;
  for (std::size_t i = 0; i < neighbours.size(); i += stride) look(neighbours[i].row);
}

}  // namespace

NearestNodes::NearestNodes(std::uint32_t vertices_max, std::uint32_t nodes_max)
    : place_of_(vertices_max, no_place), ends_(vertices_max), seen_(vertices_max) {
  set_room(nodes_max);
}

void NearestNodes::set_room(std::uint32_t nodes_max) {
  near_.resize(std::size_t{nodes_max} * nearest_nodes_max);
  count_.resize(nodes_max);
}

std::span<const NearNode> NearestNodes::around(std::uint32_t row) const {
  if (row >= row_count_ || place_of_[row] == no_place) return {};
  const std::size_t place = place_of_[row];
  return std::span(near_).subspan(place * nearest_nodes_max, count_[place]);
}

void NearestNodes::take(const Snapshot& snapshot, std::span<const std::uint32_t> rows) {
  row_count_ = static_cast<std::uint32_t>(std::min(snapshot.vertices.size(), place_of_.size()));
  find_ends(snapshot);
  std::fill(seen_.begin(), seen_.end(), 0u);
  std::fill(place_of_.begin(), place_of_.end(), no_place);
  search_ = 0;
  std::uint32_t place = 0;
  for (const std::uint32_t row : rows) {
    if (place == count_.size()) break;
    if (row >= row_count_ || place_of_[row] != no_place) continue;
    if (snapshot.vertices[row].kind != VertexKind::node) continue;
    place_of_[row] = place;
    begin_search(snapshot, row);
    add_neighbours(snapshot, row);
    // The second edge leads on from the nodes that the first one found.
    const auto first_ring = found_;
    const std::size_t first_count = found_count_;
    for (std::size_t i = 0; i < first_count; ++i) add_neighbours(snapshot, first_ring[i].row);
    std::copy_n(found_.begin(), found_count_,
                near_.data() + std::size_t{place} * nearest_nodes_max);
    count_[place++] = static_cast<std::uint8_t>(found_count_);
  }
}

void NearestNodes::find_ends(const Snapshot& snapshot) {
  std::fill(ends_.begin(), ends_.end(), Ends{});
  for (std::uint32_t row = 0; row < row_count_; ++row) {
    if (snapshot.vertices[row].kind != VertexKind::node) continue;
    for (const SnapshotNeighbour& neighbour : neighbours_of(snapshot, row)) {
      if (!neighbour.constrained) continue;
      std::uint32_t from = row;
      std::uint32_t at = neighbour.row;
      while (at < row_count_ && snapshot.vertices[at].kind == VertexKind::steiner) {
        (ends_[at].first == no_row ? ends_[at].first : ends_[at].second) = row;
        at = next_on_feature(snapshot, std::exchange(from, at), at);
      }
    }
  }
}

void NearestNodes::begin_search(const Snapshot& snapshot, std::uint32_t centre) {
  ++search_;
  centre_ = snapshot.vertices[centre].point;
  found_count_ = 0;
  seen_[centre] = search_;
}

void NearestNodes::add(const Snapshot& snapshot, std::uint32_t row) {
  if (row >= row_count_ || snapshot.vertices[row].kind != VertexKind::node) return;
  if (std::exchange(seen_[row], search_) == search_) return;
  const Point point = snapshot.vertices[row].point;
  const NearNode node{row, units_of(point.x - centre_.x), units_of(point.y - centre_.y)};
  const auto end = found_.begin() + static_cast<std::ptrdiff_t>(found_count_);
  const auto place = std::upper_bound(found_.begin(), end, node, is_nearer);
  if (place == found_.end()) return;
  const bool is_full = found_count_ == nearest_nodes_max;
  std::move_backward(place, is_full ? end - 1 : end, is_full ? end : end + 1);
  *place = node;
  if (!is_full) ++found_count_;
}

void NearestNodes::add_neighbours(const Snapshot& snapshot, std::uint32_t row) {
  look_around(snapshot, row, node_looks_max, [&](std::uint32_t neighbour) {
    if (neighbour >= row_count_) return;
    if (snapshot.vertices[neighbour].kind != VertexKind::steiner) return add(snapshot, neighbour);
    add(snapshot, ends_[neighbour].first);
    add(snapshot, ends_[neighbour].second);
    look_around(snapshot, neighbour, steiner_looks_max,
                [&](std::uint32_t beyond) { add(snapshot, beyond); });
  });
}

}  // namespace etcm::firmware
