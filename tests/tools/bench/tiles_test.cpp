// Tiles of a site, each kept by a member that knows no more than it asked for: together they have
// the triangles of the one mesh, each once.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "bench/tiles/member.h"
#include "bench/tiles/quad_tree.h"
#include "bench/tiles/sites.h"
#include "bench/tiles/survey.h"
#include "inputs/owned_mesh.h"
#include "inputs/random.h"

namespace etcm::bench {
namespace {

using inputs::Random;
using Triangles = std::vector<Corners>;

std::vector<std::uint64_t> codes_of(const std::vector<Position>& places) {
  std::vector<std::uint64_t> codes;
  for (const Position place : places) codes.push_back(morton_code(place));
  std::sort(codes.begin(), codes.end());
  codes.erase(std::unique(codes.begin(), codes.end()), codes.end());
  return codes;
}

Triangles whole_triangles(const QuadTree& tree) {
  std::vector<Position> nodes;
  for (const std::uint64_t code : tree.nodes_of(tree.branch(0))) {
    nodes.push_back(morton_place(code));
  }
  inputs::OwnedMesh mesh({.vertices_max = static_cast<std::uint32_t>(nodes.size() + 1)});
  EXPECT_EQ(mesh->build(nodes, {}), Status::ok);
  Triangles triangles;
  for_each_triangle(*mesh, tree.square(tree.branch(0)),
                    [&](const Corners& corners) { triangles.push_back(corners); });
  EXPECT_EQ(triangles.size(), mesh->triangle_count());
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

Triangles tile_triangles(const QuadTree& tree, std::uint32_t tile_max) {
  Triangles triangles;
  for (const std::uint32_t tile : tree.tiles(tile_max)) {
    const TileReport report = keep_tile(tree, tree.branch(tile), 1000, [&](const Corners& corners) {
      triangles.push_back(corners);
    });
    EXPECT_TRUE(report.is_final);
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

struct Cut {
  int side_bits = site_bits;
  std::uint32_t cell_max = 4;
  std::uint32_t tile_max = 20;
};

void expect_the_one_mesh(const std::vector<std::uint64_t>& codes, const Cut& cut) {
  const QuadTree tree(codes, cut.side_bits, cut.cell_max);
  EXPECT_EQ(tile_triangles(tree, cut.tile_max), whole_triangles(tree));
}

TEST(Tiles, OfEachKindOfSiteAreTheOneMesh) {
  for (const NamedSpread& site : spreads) {
    SCOPED_TRACE(site.name);
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      expect_the_one_mesh(spread_nodes(site.spread, 1500, seed), {.cell_max = 8, .tile_max = 100});
    }
  }
}

TEST(Tiles, OfFewNodesAreTheOneMesh) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(seed);
    const NamedSpread& site = spreads[seed % std::size(spreads)];
    expect_the_one_mesh(spread_nodes(site.spread, 1 + seed / 2, seed),
                        {.cell_max = 2, .tile_max = 5});
  }
}

// Small squares full of nodes: ties, lines and hulls along the border everywhere.
TEST(Tiles, WithTiesEverywhereAreTheOneMesh) {
  Random random(3);
  for (int round = 0; round < 150; ++round) {
    SCOPED_TRACE(round);
    const int bits = 2 + round % 4;
    const std::int32_t side = std::int32_t{1} << bits;
    std::vector<Position> places;
    for (std::uint64_t i = 0; i < 1 + random.below(100); ++i) {
      const std::int32_t x = random.between(0, side - 1);
      places.push_back({.x = x, .y = random.between(0, side - 1)});
    }
    const auto cell_max = static_cast<std::uint32_t>(1 + random.below(4));
    const auto tile_max = static_cast<std::uint32_t>(1 + random.below(20));
    expect_the_one_mesh(codes_of(places),
                        {.side_bits = bits, .cell_max = cell_max, .tile_max = tile_max});
  }
}

// Four to sixty-odd nodes on one empty circle across many tiles: which chords there are depends on
// all of them.
TEST(Tiles, OfOneEmptyCircleAreTheOneMesh) {
  std::vector<Position> places;
  // All whole places at a distance of 5 * 13 * 17 * 29.
  constexpr std::int64_t radius = 5 * 13 * 17 * 29;
  for (std::int64_t x = -radius; x <= radius; ++x) {
    const auto y = static_cast<std::int64_t>(
        std::llround(std::sqrt(static_cast<double>(radius * radius - x * x))));
    if (x * x + y * y != radius * radius) continue;
    for (const std::int64_t each : {-y, y}) {
      places.push_back({.x = static_cast<std::int32_t>(40'000 + x),
                        .y = static_cast<std::int32_t>(40'000 + each)});
    }
  }
  ASSERT_GT(places.size(), 100u);
  expect_the_one_mesh(codes_of(places), {.side_bits = 17, .cell_max = 1, .tile_max = 10});
}

TEST(Tiles, OfNodesOnALineAreTheOneMesh) {
  constexpr std::int32_t far = (1 << 24) - 1;
  const Position steps[] = {
      {.x = 1000, .y = 0}, {.x = 0, .y = 1000}, {.x = 700, .y = 700}, {.x = 901, .y = 13}};
  for (const Position step : steps) {
    std::vector<Position> places;
    for (std::int32_t i = 0; i < 200; ++i) places.push_back({.x = i * step.x, .y = i * step.y});
    SCOPED_TRACE(step.x);
    expect_the_one_mesh(codes_of(places), {});
    // One node beside the line, and it is all triangles.
    places.push_back({.x = far, .y = far - 5});
    expect_the_one_mesh(codes_of(places), {});
  }
}

// Hulls so flat that the disks of their triangles are far larger than the site.
TEST(Tiles, BelowAFlatHullAreTheOneMesh) {
  constexpr std::int32_t far = (1 << 24) - 1;
  std::vector<Position> arc;
  for (std::int32_t i = 0; i < 300; ++i) {
    const std::int32_t x = i * (far / 300);
    const std::int64_t off = std::int64_t{x} - far / 2;
    arc.push_back({.x = x, .y = static_cast<std::int32_t>(off * off / (std::int64_t{1} << 42))});
  }
  expect_the_one_mesh(codes_of(arc), {});
  Random random(9);
  for (int i = 0; i < 500; ++i) {
    const std::int32_t x = random.between(0, far);
    arc.push_back({.x = x, .y = random.between(far / 2, far)});
  }
  expect_the_one_mesh(codes_of(arc), {.cell_max = 8, .tile_max = 60});
}

// Both sides of each border between squares, and the corners where four meet.
TEST(Tiles, OfNodesOnBordersAreTheOneMesh) {
  std::vector<Position> places;
  for (std::int32_t x = 0; x < 8; ++x) {
    for (std::int32_t y = 0; y < 8; ++y) {
      for (const std::int32_t dx : {0, 63}) {
        for (const std::int32_t dy : {0, 63}) {
          places.push_back({.x = 64 * x + dx, .y = 64 * y + dy});
        }
      }
    }
  }
  for (const std::uint32_t tile_max : {4u, 16u, 64u}) {
    expect_the_one_mesh(codes_of(places), {.side_bits = 9, .cell_max = 4, .tile_max = tile_max});
  }
}

TEST(Tiles, WithoutNodesBetweenFarHeapsAreTheOneMesh) {
  std::vector<Position> places;
  Random random(11);
  constexpr std::int32_t side = 1 << 24;
  for (const Position heap : {Position{0, 0}, Position{side - 200, 50}, Position{90, side - 300},
                              Position{side / 2 - 50, side / 2 - 50}}) {
    for (int i = 0; i < 60; ++i) {
      const std::int32_t x = heap.x + random.between(0, 199);
      places.push_back({.x = x, .y = heap.y + random.between(0, 199)});
    }
  }
  expect_the_one_mesh(codes_of(places), {});
}

TEST(Tiles, OneOrAsManyAsNodesAreTheOneMesh) {
  const std::vector<std::uint64_t> codes = spread_nodes(Spread::even, 300, 12);
  expect_the_one_mesh(codes, {.tile_max = 300});
  expect_the_one_mesh(codes, {.cell_max = 1, .tile_max = 1});
  expect_the_one_mesh({}, {});
}

Triangles moved_triangles(const QuadTree& moved, const std::vector<std::uint32_t>& tiles) {
  Triangles triangles;
  for (const std::uint32_t tile : tiles) {
    keep_tile(moved, moved.branch(tile), 1000,
              [&](const Corners& corners) { triangles.push_back(corners); });
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

// Squares are cut for some nodes and then hold others, down to one.
TEST(Tiles, OfNodesThatHaveMovedAreTheOneMesh) {
  const std::vector<std::uint64_t> before = spread_nodes(Spread::even, 400, 15);
  const QuadTree tree(before, site_bits, 2);
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    const std::vector<std::uint64_t> after =
        spread_nodes(seed % 2 == 0 ? Spread::even : Spread::towns, 1 + seed / 2, seed);
    const QuadTree moved = tree.with_nodes(after);
    EXPECT_EQ(moved_triangles(moved, tree.tiles(10)), whole_triangles(moved));
  }
}

// Each place is a cell, and those of a row can be unknown while all beside it are known.
TEST(Tiles, OfAFewNodesInARowOfSmallestCellsAreTheOneMesh) {
  std::vector<Position> all;
  for (std::int32_t x = 0; x < 16; ++x) {
    for (std::int32_t y = 0; y < 16; ++y) all.push_back({.x = x, .y = y});
  }
  const std::vector<std::uint64_t> before = codes_of(all);
  const QuadTree tree(before, 4, 1);
  Random random(16);
  for (int round = 0; round < 100; ++round) {
    SCOPED_TRACE(round);
    std::vector<Position> row;
    const std::int32_t level = random.between(0, 15);
    for (int i = 0; i < 3; ++i) {
      const std::int32_t along = random.between(0, 15);
      row.push_back(round % 2 == 0 ? Position{.x = along, .y = level}
                                   : Position{.x = level, .y = along});
    }
    const std::vector<std::uint64_t> after = codes_of(row);
    const QuadTree moved = tree.with_nodes(after);
    EXPECT_EQ(moved_triangles(moved, tree.tiles(4)), whole_triangles(moved));
  }
}

TEST(Tiles, ThatStopOneMeshTooEarlySayTheyAreNotFinalAndAreNotTheOneMesh) {
  const std::vector<std::uint64_t> codes = spread_nodes(Spread::towns, 3000, 13);
  const QuadTree tree(codes, site_bits, 4);
  const Triangles whole = whole_triangles(tree);
  int early = 0, wrong = 0;
  for (const std::uint32_t tile : tree.tiles(60)) {
    const int meshes = keep_tile(tree, tree.branch(tile)).meshes;
    if (meshes < 2) continue;
    ++early;
    bool is_wrong = false;
    const TileReport report =
        keep_tile(tree, tree.branch(tile), meshes - 1, [&](const Corners& corners) {
          is_wrong = is_wrong || !std::binary_search(whole.begin(), whole.end(), corners);
        });
    EXPECT_FALSE(report.is_final);
    wrong += is_wrong ? 1 : 0;
  }
  EXPECT_GT(early, 20);
  EXPECT_GT(wrong, 5);
}

TEST(Tiles, SurveyedAddUpToTheOneMeshAndAMoveIsToldToAllThatKnowIt) {
  const std::vector<std::uint64_t> codes = spread_nodes(Spread::even, 3000, 14);
  const QuadTree tree(codes, site_bits, 8);
  Survey survey = survey_tiles(tree, 200);
  EXPECT_EQ(survey.sum, one_mesh(tree));
  EXPECT_EQ(survey.knowers.size(), tree.cell_count());
  for (const auto& knowers : survey.knowers) EXPECT_GE(knowers.size(), 1u);
  Hearing hearing = hear_moves(tree, survey, 300, 1);
  EXPECT_GE(hearing.of_step.quantile(0), 1);
  EXPECT_GE(hearing.of_jump.mean(), hearing.of_step.mean());
  EXPECT_LE(hearing.of_jump.quantile(1), static_cast<double>(survey.tiles.size()));
}

}  // namespace
}  // namespace etcm::bench
