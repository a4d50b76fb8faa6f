#include "inputs/placer.h"

#include <algorithm>

namespace etcm::inputs {
namespace {

// Differences are at most 2^25, so the products fit.
int turn(Position a, Position b, Position c) noexcept {
  const std::int64_t ux = std::int64_t{b.x} - a.x;
  const std::int64_t uy = std::int64_t{b.y} - a.y;
  const std::int64_t vx = std::int64_t{c.x} - a.x;
  const std::int64_t vy = std::int64_t{c.y} - a.y;
  const std::int64_t cross = ux * vy - uy * vx;
  return (cross > 0) - (cross < 0);
}

bool in_box(Position p, Position a, Position b) noexcept {
  return p.x >= std::min(a.x, b.x) && p.x <= std::max(a.x, b.x) && p.y >= std::min(a.y, b.y) &&
         p.y <= std::max(a.y, b.y);
}

bool lies_inside(Position p, Position a, Position b) noexcept {
  return p != a && p != b && in_box(p, a, b) && turn(a, b, p) == 0;
}

bool cross_inside(Position a, Position b, Position c, Position d) noexcept {
  return turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0;
}

}  // namespace

Placer::Placer(std::span<const Position> nodes, std::int32_t cell_size)
    : nodes_(nodes), low_(nodes.front()), cell_size_(cell_size) {
  Position high = low_;
  for (const Position node : nodes) {
    low_ = {std::min(low_.x, node.x), std::min(low_.y, node.y)};
    high = {std::max(high.x, node.x), std::max(high.y, node.y)};
  }
  columns_ = (high.x - low_.x) / cell_size + 1;
  rows_ = (high.y - low_.y) / cell_size + 1;
  cells_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
  for (std::size_t node = 0; node < nodes.size(); ++node) {
    const std::size_t cell = index(column(nodes[node].x), row(nodes[node].y));
    cells_[cell].nodes.push_back(static_cast<std::uint32_t>(node));
  }
}

bool Placer::try_add(std::size_t from, std::size_t to) {
  if (from == to) return false;
  const Cells around = covered(nodes_[from], nodes_[to]);
  for (std::int32_t r = around.bottom; r <= around.top; ++r) {
    for (std::int32_t c = around.left; c <= around.right; ++c) {
      if (blocked_by_feature(cells_[index(c, r)], from, to)) return false;
    }
  }
  for (std::int32_t r = around.bottom; r <= around.top; ++r) {
    for (std::int32_t c = around.left; c <= around.right; ++c) {
      if (blocked_by_node(cells_[index(c, r)], from, to)) return false;
    }
  }
  for (std::int32_t r = around.bottom; r <= around.top; ++r) {
    for (std::int32_t c = around.left; c <= around.right; ++c) {
      cells_[index(c, r)].features.push_back(static_cast<std::uint32_t>(features_.size()));
    }
  }
  features_.push_back(between_nodes(from, to));
  return true;
}

std::size_t Placer::random_near(std::size_t node, Random& random) const {
  const std::int32_t c0 = column(nodes_[node].x);
  const std::int32_t r0 = row(nodes_[node].y);
  std::array<const Cell*, 9> near{};
  std::size_t near_count = 0;
  std::size_t node_count = 0;
  for (std::int32_t r = std::max(r0 - 1, 0); r <= std::min(r0 + 1, rows_ - 1); ++r) {
    for (std::int32_t c = std::max(c0 - 1, 0); c <= std::min(c0 + 1, columns_ - 1); ++c) {
      near[near_count] = &cells_[index(c, r)];
      node_count += near[near_count++]->nodes.size();
    }
  }
  std::size_t chosen = random.index(node_count);
  std::size_t cell = 0;
  while (chosen >= near[cell]->nodes.size()) chosen -= near[cell++]->nodes.size();
  return near[cell]->nodes[chosen];
}

std::int32_t Placer::column(std::int32_t x) const noexcept { return (x - low_.x) / cell_size_; }
std::int32_t Placer::row(std::int32_t y) const noexcept { return (y - low_.y) / cell_size_; }

Placer::Cells Placer::covered(Position a, Position b) const noexcept {
  return {column(std::min(a.x, b.x)), column(std::max(a.x, b.x)), row(std::min(a.y, b.y)),
          row(std::max(a.y, b.y))};
}

std::size_t Placer::index(std::int32_t cell_column, std::int32_t cell_row) const noexcept {
  return static_cast<std::size_t>(cell_row) * static_cast<std::size_t>(columns_) +
         static_cast<std::size_t>(cell_column);
}

// Two features that overlap need no test of their own: an end of one is then on the inside of the
// other, unless they are equal.
bool Placer::blocked_by_feature(const Cell& cell, std::size_t from, std::size_t to) const noexcept {
  return std::any_of(cell.features.begin(), cell.features.end(), [&](std::uint32_t feature) {
    const std::size_t a = node_index_of(features_[feature].from);
    const std::size_t b = node_index_of(features_[feature].to);
    if ((a == from && b == to) || (a == to && b == from)) return true;
    return cross_inside(nodes_[a], nodes_[b], nodes_[from], nodes_[to]);
  });
}

bool Placer::blocked_by_node(const Cell& cell, std::size_t from, std::size_t to) const noexcept {
  return std::any_of(cell.nodes.begin(), cell.nodes.end(), [&](std::uint32_t node) {
    return lies_inside(nodes_[node], nodes_[from], nodes_[to]);
  });
}

}  // namespace etcm::inputs
