#include "bench/tiles/survey.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <set>
#include <stdexcept>

#include "bench/tiles/member.h"
#include "inputs/owned_mesh.h"
#include "inputs/random.h"

namespace etcm::bench {

namespace {

// Up to twice the distance between nodes of the cell, on the site.
Position step_from(Position place, const QuadTree::Branch& cell, const Square& site,
                   inputs::Random& random) {
  const double width = std::ldexp(1.0, cell.bits);
  const auto reach =
      static_cast<std::int32_t>(2 * width / std::sqrt(std::max(1.0, double{1} * cell.size())));
  const std::int32_t x = place.x + random.between(-reach, reach);
  const std::int32_t y = place.y + random.between(-reach, reach);
  return {.x = std::clamp(x, site.low.x, site.high.x), .y = std::clamp(y, site.low.y, site.high.y)};
}

std::size_t hearers(const Survey& survey, std::uint32_t from, std::uint32_t to) {
  std::set<std::uint32_t> members(survey.knowers[from].begin(), survey.knowers[from].end());
  members.insert(survey.knowers[to].begin(), survey.knowers[to].end());
  return members.size();
}

// One node of a tile in so many takes a step.
constexpr std::uint32_t moving = 20;

// The cells that one tile's member asks for when some of its nodes have moved.
void ask_again(const QuadTree& tree, std::uint32_t tile, Hearing& hearing, inputs::Random& random) {
  const QuadTree::Branch& before = tree.branch(tile);
  std::vector<std::uint32_t> had = keep_tile(tree, before).halo;
  const auto all = tree.nodes_of(tree.branch(0));
  std::vector<std::uint64_t> codes(all.begin(), all.end());
  std::size_t moves = 0;
  for (std::uint32_t i = before.first_node; i < before.end_node; i += moving, ++moves) {
    const QuadTree::Branch& cell = tree.cell(tree.cell_of(codes[i]));
    codes[i] = morton_code(step_from(morton_place(codes[i]), cell, tree.square(before), random));
  }
  std::sort(codes.begin(), codes.end());
  codes.erase(std::unique(codes.begin(), codes.end()), codes.end());
  const QuadTree moved = tree.with_nodes(codes);
  std::vector<std::uint32_t> has = keep_tile(moved, moved.branch(tile)).halo;
  std::sort(had.begin(), had.end());
  std::sort(has.begin(), has.end());
  std::vector<std::uint32_t> more;
  std::set_difference(has.begin(), has.end(), had.begin(), had.end(), std::back_inserter(more));
  if (moves > 0) hearing.asked.add(static_cast<double>(more.size()) / static_cast<double>(moves));
  hearing.halo_cells += had.size();
}

}  // namespace

double processor_seconds() {
  return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC);
}

Survey survey_tiles(const QuadTree& tree, std::uint32_t nodes_max) {
  Survey survey;
  survey.tiles = tree.tiles(nodes_max);
  survey.knowers.resize(tree.cell_count());
  std::vector<std::uint32_t> tile_of(tree.cell_count());
  for (std::uint32_t i = 0; i < survey.tiles.size(); ++i) {
    const QuadTree::Branch& tile = tree.branch(survey.tiles[i]);
    for (std::uint32_t cell = tile.first_cell; cell < tile.end_cell; ++cell) {
      tile_of[cell] = i;
      survey.knowers[cell].push_back(i);
    }
  }
  const double start = processor_seconds();
  for (std::uint32_t i = 0; i < survey.tiles.size(); ++i) {
    const TileReport report = keep_tile(tree, tree.branch(survey.tiles[i]));
    if (!report.is_final) throw std::runtime_error("a tile does not end");
    survey.sum.add(report.own);
    if (report.own_nodes == 0) continue;
    std::set<std::uint32_t> sources;
    for (const std::uint32_t cell : report.halo) {
      survey.knowers[cell].push_back(i);
      sources.insert(tile_of[cell]);
    }
    const double own = report.own_nodes;
    survey.halo_percent.add(100 * (report.known_nodes - own) / own);
    survey.filters.add(report.filters);
    survey.sources.add(static_cast<double>(sources.size()));
    survey.meshes.add(report.meshes);
  }
  survey.seconds = processor_seconds() - start;
  return survey;
}

TriangleSum one_mesh(const QuadTree& tree) {
  const auto codes = tree.nodes_of(tree.branch(0));
  std::vector<Position> nodes;
  nodes.reserve(codes.size());
  for (const std::uint64_t code : codes) nodes.push_back(morton_place(code));
  inputs::OwnedMesh mesh({.vertices_max = static_cast<std::uint32_t>(nodes.size() + 1)});
  if (mesh.opened() != Status::ok || mesh->build(nodes, {}) != Status::ok) {
    throw std::runtime_error("the one mesh fails");
  }
  return triangles_in(*mesh, tree.square(tree.branch(0)));
}

Hearing hear_moves(const QuadTree& tree, const Survey& survey, std::size_t moves,
                   std::uint64_t seed) {
  Hearing hearing{};
  if (moves == 0) return hearing;
  inputs::Random random(seed);
  const Square site = tree.square(tree.branch(0));
  const auto codes = tree.nodes_of(tree.branch(0));
  for (std::size_t i = 0; i < moves; ++i) {
    const std::uint64_t code = codes[random.index(codes.size())];
    const std::uint32_t from = tree.cell_of(code);
    const Position step = step_from(morton_place(code), tree.cell(from), site, random);
    const auto to = tree.cell_of(morton_code(step));
    hearing.of_step.add(static_cast<double>(hearers(survey, from, to)));
    const std::int32_t x = random.between(site.low.x, site.high.x);
    const Position jump{.x = x, .y = random.between(site.low.y, site.high.y)};
    const auto far = tree.cell_of(morton_code(jump));
    hearing.of_jump.add(static_cast<double>(hearers(survey, from, far)));
  }
  constexpr std::size_t tiles_asked = 20;
  for (std::size_t i = 0; i < tiles_asked; ++i) {
    ask_again(tree, survey.tiles[random.index(survey.tiles.size())], hearing, random);
  }
  hearing.halo_cells /= tiles_asked;
  return hearing;
}

}  // namespace etcm::bench
