// A site's square cut by Morton prefixes, exactly and nested: a square is a prefix of the bits of
// its places, interleaved. Cells are the leaves; a tile is a square whose nodes one member keeps.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "etcm/types.h"

namespace etcm::bench {

// The bits of x and y by turns, y first. REQUIRES: 0 <= x, y < 2^24.
std::uint64_t morton_code(Position place) noexcept;
Position morton_place(std::uint64_t code) noexcept;

// Places low.x ... high.x, low.y ... high.y.
struct Square {
  Position low;
  Position high;
};

inline constexpr int site_bits_max = 24;  // of a side

class QuadTree {
 public:
  struct Branch {
    std::uint64_t code = 0;   // of its low corner
    Position low{};           // that corner
    int bits = 0;             // of its side
    std::uint32_t child = 0;  // the first of four, in the order of codes; 0: it is a cell
    std::uint32_t first_node = 0;
    std::uint32_t end_node = 0;
    std::uint32_t first_cell = 0;
    std::uint32_t end_cell = 0;
    std::uint32_t size() const { return end_node - first_node; }
  };

  // Of a site with a side of 2^side_bits places; no cell has more than `cell_max` nodes. `codes`
  // must be sorted, without repetition, and outlive it. O(n).
  QuadTree(std::span<const std::uint64_t> codes, int side_bits, std::uint32_t cell_max);

  // The same squares with other nodes, sorted and different as above. O(n).
  QuadTree with_nodes(std::span<const std::uint64_t> codes) const;

  std::uint32_t branch_count() const { return static_cast<std::uint32_t>(branches_.size()); }
  // 0 is the root.
  const Branch& branch(std::uint32_t number) const { return branches_[number]; }
  Square square(const Branch& branch) const {
    const std::int32_t last = (std::int32_t{1} << branch.bits) - 1;
    return {.low = branch.low, .high = {.x = branch.low.x + last, .y = branch.low.y + last}};
  }

  std::uint32_t cell_count() const { return static_cast<std::uint32_t>(cells_.size()); }
  const Branch& cell(std::uint32_t number) const { return branches_[cells_[number]]; }
  std::span<const std::uint64_t> nodes_of(const Branch& branch) const {
    return codes_.subspan(branch.first_node, branch.size());
  }
  // Visits the branches that a cell is in, from the root to the cell itself.
  template <class Visit>
  void for_each_around(std::uint32_t cell, Visit visit) const;
  // In which a place is.
  std::uint32_t cell_of(std::uint64_t code) const;

  // The largest squares of no more than `nodes_max` nodes, in the order of codes.
  std::vector<std::uint32_t> tiles(std::uint32_t nodes_max) const;

  // The fewest squares that are these cells and no others: so many filters a member subscribes to.
  std::uint32_t squares_of(const std::vector<bool>& cells) const;

  // Visits each cell, by its number, for which `meets(branch number, square)` is true, and is for
  // all branches that it is in.
  template <class Meets, class Visit>
  void for_each_cell(Meets meets, Visit visit) const;

 private:
  std::span<const std::uint64_t> codes_;
  std::vector<Branch> branches_;
  std::vector<std::uint32_t> cells_;  // branches
};

template <class Visit>
void QuadTree::for_each_around(std::uint32_t cell, Visit visit) const {
  std::uint32_t number = 0;
  visit(number);
  while (branches_[number].child != 0) {
    number = branches_[number].child;
    while (branches_[number].end_cell <= cell) ++number;
    visit(number);
  }
}

template <class Meets, class Visit>
void QuadTree::for_each_cell(Meets meets, Visit visit) const {
  // Three of each level wait while the fourth is looked at.
  std::array<std::uint32_t, 3 * site_bits_max + 1> open{0};
  std::size_t count = 1;
  while (count > 0) {
    const std::uint32_t number = open[--count];
    const Branch& at = branches_[number];
    if (!meets(number, square(at))) continue;
    if (at.child == 0) {
      visit(at.first_cell);
      continue;
    }
    for (std::uint32_t i = 0; i < 4; ++i) open[count++] = at.child + i;
  }
}

}  // namespace etcm::bench
