// Squares of a site, and what an empty disk asks of them, beside every place asked one by one.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "bench/tiles/emptiness.h"
#include "bench/tiles/quad_tree.h"
#include "bench/tiles/sites.h"
#include "etcm/predicates.h"
#include "inputs/random.h"

namespace etcm::bench {
namespace {

using inputs::Random;

TEST(Morton, CodesAndPlacesAreTheSame) {
  Random random(1);
  EXPECT_EQ(morton_code({.x = 1, .y = 0}), 1u);
  EXPECT_EQ(morton_code({.x = 0, .y = 1}), 2u);
  EXPECT_EQ(morton_code({.x = 2, .y = 3}), 14u);
  for (int i = 0; i < 1000; ++i) {
    const Position place{.x = random.between(0, (1 << 24) - 1),
                         .y = random.between(0, (1 << 24) - 1)};
    EXPECT_EQ(morton_place(morton_code(place)), place);
  }
}

Position any_tile_place(Random& random, std::int32_t side) {
  return {.x = random.between(0, side), .y = random.between(0, side)};
}

// In small squares each place can be asked.
TEST(Emptiness, MeetsASquareWhereAPlaceOfItIsInside) {
  Random random(2);
  int disks = 0, meetings = 0;
  for (int round = 0; round < 20000; ++round) {
    const std::int32_t side = 3 + static_cast<std::int32_t>(random.below(40));
    const Position a = any_tile_place(random, side), b = any_tile_place(random, side),
                   c = any_tile_place(random, side);
    const Position low{.x = random.between(-10, side), .y = random.between(-10, side)};
    const Square square{
        .low = low,
        .high = {.x = low.x + random.between(0, 15), .y = low.y + random.between(0, 15)}};
    const bool is_disk = orient2d(to_point(a), to_point(b), to_point(c)) > 0;
    if (a == b) continue;
    const Emptiness empty = is_disk ? Emptiness::disk(a, b, c) : Emptiness::half_plane(a, b);
    bool is_any = false;
    for (std::int32_t x = square.low.x; x <= square.high.x; ++x) {
      for (std::int32_t y = square.low.y; y <= square.high.y; ++y) {
        const Point place = to_point(Position{.x = x, .y = y});
        if (is_disk) {
          is_any = is_any || incircle(to_point(a), to_point(b), to_point(c), place) >= 0;
        } else {
          const int side_of_line = orient2d(to_point(a), to_point(b), place);
          is_any = is_any || side_of_line > 0 ||
                   (side_of_line == 0 && x >= std::min(a.x, b.x) && x <= std::max(a.x, b.x) &&
                    y >= std::min(a.y, b.y) && y <= std::max(a.y, b.y));
        }
      }
    }
    EXPECT_EQ(empty.meets(square), is_any) << "round " << round;
    disks += is_disk ? 1 : 0;
    meetings += is_any ? 1 : 0;
  }
  EXPECT_GT(disks, 5000);
  EXPECT_GT(meetings, 2000);
}

// Flat triangles at the ends of the range, whose middle is far away: the corners are in the disk.
TEST(Emptiness, HoldsForTheFlattestTriangles) {
  const std::int32_t far = (1 << 24) - 1;
  const std::vector<std::array<Position, 3>> triangles{
      {Position{0, 0}, Position{far, 0}, Position{far / 2, 1}},
      {Position{0, 0}, Position{far, far}, Position{far / 2, far / 2 + 1}},
      {Position{0, 0}, Position{far, far - 1}, Position{1, 1}},
      {Position{0, far}, Position{1, far - 1}, Position{far, 1}},
      {Position{0, 0}, Position{1, 0}, Position{0, 1}},
  };
  for (const auto& [a, b, c] : triangles) {
    ASSERT_GT(orient2d(to_point(a), to_point(b), to_point(c)), 0);
    const Emptiness empty = Emptiness::disk(a, b, c);
    for (const Position corner : {a, b, c}) {
      EXPECT_TRUE(empty.meets({.low = corner, .high = corner}));
      EXPECT_FALSE(empty.is_surely_within({.low = corner, .high = corner}));
    }
    EXPECT_TRUE(empty.meets({.low = {0, 0}, .high = {far, far}}));
  }
}

TEST(QuadTree, CellsHoldAllNodesOnceAndAreFoundAgain) {
  const std::vector<std::uint64_t> codes = spread_nodes(Spread::towns, 5000, 3);
  const QuadTree tree(codes, site_bits, 16);
  std::uint32_t next = 0;
  for (std::uint32_t i = 0; i < tree.cell_count(); ++i) {
    const QuadTree::Branch& cell = tree.cell(i);
    EXPECT_EQ(cell.first_node, next);
    EXPECT_LE(cell.size(), 16u);
    next = cell.end_node;
    const Square square = tree.square(cell);
    for (const std::uint64_t code : tree.nodes_of(cell)) {
      const Position at = morton_place(code);
      EXPECT_TRUE(at.x >= square.low.x && at.x <= square.high.x && at.y >= square.low.y &&
                  at.y <= square.high.y);
      EXPECT_EQ(tree.cell_of(code), i);
    }
    std::vector<std::uint32_t> around;
    tree.for_each_around(i, [&](std::uint32_t branch) { around.push_back(branch); });
    EXPECT_EQ(around.front(), 0u);
    EXPECT_EQ(&tree.branch(around.back()), &cell);
  }
  EXPECT_EQ(next, codes.size());
  std::uint32_t tiled = 0;
  for (const std::uint32_t tile : tree.tiles(500)) {
    EXPECT_EQ(tree.branch(tile).first_node, tiled);
    tiled = tree.branch(tile).end_node;
  }
  EXPECT_EQ(tiled, codes.size());
}

TEST(QuadTree, CellsAreVisitedThatMeet) {
  const std::vector<std::uint64_t> codes = spread_nodes(Spread::even, 2000, 4);
  const QuadTree tree(codes, site_bits, 8);
  Random random(5);
  for (int round = 0; round < 100; ++round) {
    const Position a = any_tile_place(random, 1 << 23), b = any_tile_place(random, 1 << 23),
                   c = any_tile_place(random, 1 << 23);
    if (orient2d(to_point(a), to_point(b), to_point(c)) <= 0) continue;
    const Emptiness empty = Emptiness::disk(a, b, c);
    std::vector<std::uint32_t> visited, meeting;
    tree.for_each_cell([&](std::uint32_t, const Square& square) { return empty.meets(square); },
                       [&](std::uint32_t cell) { visited.push_back(cell); });
    for (std::uint32_t i = 0; i < tree.cell_count(); ++i) {
      if (empty.meets(tree.square(tree.cell(i)))) meeting.push_back(i);
    }
    std::sort(visited.begin(), visited.end());
    EXPECT_EQ(visited, meeting);
  }
}

// Of random cells, beside all squares that hold nothing else and are in none that does.
TEST(QuadTree, FewestSquaresThatAreSomeCells) {
  const std::vector<std::uint64_t> codes = spread_nodes(Spread::towns, 600, 6);
  const QuadTree tree(codes, site_bits, 4);
  Random random(7);
  for (int round = 0; round < 50; ++round) {
    std::vector<bool> cells;
    for (std::uint32_t i = 0; i < tree.cell_count(); ++i) cells.push_back(random.below(8) != 0);
    const auto is_whole = [&](const QuadTree::Branch& branch) {
      return std::all_of(cells.begin() + branch.first_cell, cells.begin() + branch.end_cell,
                         [](bool is_one) { return is_one; });
    };
    std::uint32_t expected = is_whole(tree.branch(0)) ? 1 : 0;
    for (std::uint32_t i = 0; i < tree.branch_count(); ++i) {
      const QuadTree::Branch& branch = tree.branch(i);
      if (branch.child == 0 || is_whole(branch)) continue;
      for (std::uint32_t k = 0; k < 4; ++k) {
        expected += is_whole(tree.branch(branch.child + k)) ? 1 : 0;
      }
    }
    EXPECT_EQ(tree.squares_of(cells), expected);
  }
}

}  // namespace
}  // namespace etcm::bench
