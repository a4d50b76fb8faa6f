#include "bench/tiles/quad_tree.h"

#include <algorithm>

namespace etcm::bench {

namespace {

// Every second bit, from the lowest.
std::uint64_t spread(std::uint64_t value) noexcept {
  value = (value | value << 16) & 0x0000ffff0000ffff;
  value = (value | value << 8) & 0x00ff00ff00ff00ff;
  value = (value | value << 4) & 0x0f0f0f0f0f0f0f0f;
  value = (value | value << 2) & 0x3333333333333333;
  return (value | value << 1) & 0x5555555555555555;
}

std::int32_t gather(std::uint64_t value) noexcept {
  value &= 0x5555555555555555;
  value = (value | value >> 1) & 0x3333333333333333;
  value = (value | value >> 2) & 0x0f0f0f0f0f0f0f0f;
  value = (value | value >> 4) & 0x00ff00ff00ff00ff;
  value = (value | value >> 8) & 0x0000ffff0000ffff;
  return static_cast<std::int32_t>((value | value >> 16) & 0x00000000ffffffff);
}

}  // namespace

std::uint64_t morton_code(Position place) noexcept {
  return spread(static_cast<std::uint32_t>(place.x)) | spread(static_cast<std::uint32_t>(place.y))
                                                           << 1;
}

Position morton_place(std::uint64_t code) noexcept {
  return {.x = gather(code), .y = gather(code >> 1)};
}

QuadTree::QuadTree(std::span<const std::uint64_t> codes, int side_bits, std::uint32_t cell_max)
    : codes_(codes) {
  branches_.push_back({.bits = side_bits, .end_node = static_cast<std::uint32_t>(codes.size())});
  // Depth first, so that cells come in the order of codes.
  std::vector<std::uint32_t> open{0};
  while (!open.empty()) {
    const std::uint32_t number = open.back();
    open.pop_back();
    Branch at = branches_[number];
    if (at.size() <= cell_max || at.bits == 0) {
      cells_.push_back(number);
      continue;
    }
    at.child = static_cast<std::uint32_t>(branches_.size());
    branches_[number].child = at.child;
    const int bits = at.bits - 1;
    std::uint32_t first = at.first_node;
    for (std::uint64_t i = 0; i < 4; ++i) {
      const std::uint64_t code = at.code + (i << (2 * bits));
      const std::uint64_t next = code + (std::uint64_t{1} << (2 * bits));
      const auto end = std::lower_bound(codes.begin() + first, codes.begin() + at.end_node, next);
      const auto end_node = static_cast<std::uint32_t>(end - codes.begin());
      branches_.push_back({.code = code,
                           .low = morton_place(code),
                           .bits = bits,
                           .first_node = first,
                           .end_node = end_node});
      first = end_node;
    }
    for (std::uint32_t i = 4; i-- > 0;) open.push_back(at.child + i);
  }
  for (std::uint32_t i = 0; i < cells_.size(); ++i) {
    branches_[cells_[i]].first_cell = i;
    branches_[cells_[i]].end_cell = i + 1;
  }
  // Children stand behind their branch.
  for (std::size_t i = branches_.size(); i-- > 0;) {
    Branch& at = branches_[i];
    if (at.child == 0) continue;
    at.first_cell = branches_[at.child].first_cell;
    at.end_cell = branches_[at.child + 3].end_cell;
  }
}

QuadTree QuadTree::with_nodes(std::span<const std::uint64_t> codes) const {
  QuadTree other = *this;
  other.codes_ = codes;
  const auto number_of = [codes](std::uint64_t code) {
    return static_cast<std::uint32_t>(std::lower_bound(codes.begin(), codes.end(), code) -
                                      codes.begin());
  };
  for (Branch& branch : other.branches_) {
    branch.first_node = number_of(branch.code);
    branch.end_node = number_of(branch.code + (std::uint64_t{1} << (2 * branch.bits)));
  }
  return other;
}

std::uint32_t QuadTree::cell_of(std::uint64_t code) const {
  const auto after = std::upper_bound(
      cells_.begin(), cells_.end(), code,
      [this](std::uint64_t value, std::uint32_t cell) { return value < branches_[cell].code; });
  return static_cast<std::uint32_t>(after - cells_.begin()) - 1;
}

std::uint32_t QuadTree::squares_of(const std::vector<bool>& cells) const {
  std::vector<std::uint32_t> before{0};  // of those before a cell, how many are asked for
  before.reserve(cells.size() + 1);
  for (const bool is_one : cells) before.push_back(before.back() + (is_one ? 1 : 0));
  std::uint32_t squares = 0;
  std::vector<std::uint32_t> open{0};
  while (!open.empty()) {
    const Branch& at = branches_[open.back()];
    open.pop_back();
    const std::uint32_t inside = before[at.end_cell] - before[at.first_cell];
    if (inside == at.end_cell - at.first_cell) {
      ++squares;
    } else if (inside > 0) {
      for (std::uint32_t i = 0; i < 4; ++i) open.push_back(at.child + i);
    }
  }
  return squares;
}

std::vector<std::uint32_t> QuadTree::tiles(std::uint32_t nodes_max) const {
  std::vector<std::uint32_t> tiles;
  std::vector<std::uint32_t> open{0};
  while (!open.empty()) {
    const std::uint32_t number = open.back();
    open.pop_back();
    const Branch& at = branches_[number];
    if (at.size() <= nodes_max || at.child == 0) {
      tiles.push_back(number);
      continue;
    }
    for (std::uint32_t i = 4; i-- > 0;) open.push_back(at.child + i);
  }
  return tiles;
}

}  // namespace etcm::bench
