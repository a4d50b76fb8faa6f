#include "bench/tiles/member.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "bench/tiles/emptiness.h"
#include "inputs/owned_mesh.h"

namespace etcm::bench {

namespace {

Square widened(const Square& square, std::int32_t by) noexcept {
  return {.low = {.x = square.low.x - by, .y = square.low.y - by},
          .high = {.x = square.high.x + by, .y = square.high.y + by}};
}

bool overlap(const Square& a, const Square& b) noexcept {
  return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y;
}

class Member {
 public:
  Member(const QuadTree& tree, const QuadTree::Branch& tile)
      : tree_(tree),
        tile_(tile),
        square_(tree.square(tile)),
        is_known_(tree.cell_count()),
        known_in_(tree.branch_count()) {
    // A cell's width, on average: so the first halo is about a ring of cells.
    const double cells = tile.end_cell - tile.first_cell;
    reach_ = std::max(1, static_cast<std::int32_t>(std::ldexp(1.0, tile.bits) / std::sqrt(cells)));
    learn_around();
  }

  // Whether all triangles at nodes of the tile are final; if not, more is known than before.
  bool make_mesh(const std::function<void(const Corners&)>& visit) {
    std::vector<Position> nodes;
    for (const std::uint32_t cell : known_) {
      for (const std::uint64_t code : tree_.nodes_of(tree_.cell(cell))) {
        nodes.push_back(morton_place(code));
      }
    }
    inputs::OwnedMesh mesh(
        {.vertices_max = static_cast<std::uint32_t>(std::max<std::size_t>(1, nodes.size()))});
    if (mesh->build(nodes, {}) != Status::ok) throw std::runtime_error("a tile's mesh fails");
    for_each_triangle(*mesh, square_, visit);
    return !is_more_learnt(*mesh);
  }

  void report(TileReport& report) const {
    report.own_nodes = tile_.size();
    for (const std::uint32_t cell : known_) {
      report.known_nodes += tree_.cell(cell).size();
      if (cell < tile_.first_cell || cell >= tile_.end_cell) report.halo.push_back(cell);
    }
    report.filters = tree_.squares_of(is_known_);
  }

 private:
  void learn(std::uint32_t cell) {
    if (is_known_[cell]) return;
    is_known_[cell] = true;
    known_.push_back(cell);
    tree_.for_each_around(cell, [this](std::uint32_t branch) { ++known_in_[branch]; });
  }

  void learn_around() {
    const Square around = widened(square_, reach_);
    tree_.for_each_cell(
        [&](std::uint32_t, const Square& square) { return overlap(square, around); },
        [&](std::uint32_t cell) { learn(cell); });
  }

  void widen() { reach_ = std::min(2 * reach_, std::int32_t{1} << site_bits_max); }

  bool is_more_learnt(const Mesh& mesh) {
    const std::size_t before = known_.size();
    // Where all nodes are on a line, any other node anywhere is a neighbour of one of them.
    if (mesh.finite_triangle_count() == 0) {
      while (known_.size() == before && before < tree_.cell_count()) {
        learn_around();
        widen();
      }
      return known_.size() != before;
    }
    while (true) {
      is_lacking_ = false;
      for (std::uint32_t i = 0; i < mesh.triangle_count(); ++i) {
        ask(mesh, mesh.triangle(TriangleId{static_cast<IdValue>(i)}));
      }
      if (!is_lacking_) return false;
      if (known_.size() != before) return true;
      widen();
    }
  }

  // Learns what the triangle needs to be final, as far as it is near: most of what a large disk
  // meets is of no matter once something nearer is known.
  void ask(const Mesh& mesh, const Triangle& triangle) {
    const bool is_own =
        std::any_of(triangle.corner.begin(), triangle.corner.end(), [&](VertexId vertex) {
          return vertex != infinite_vertex && is_in(mesh.point(vertex), square_);
        });
    if (!is_own) return;
    const Emptiness empty = Emptiness::of(mesh, triangle);
    if (empty.is_surely_within(square_)) return;
    const Square near = widened(square_, 2 * reach_);
    const auto is_asked_for = [&](std::uint32_t number, const Square& square) {
      const QuadTree::Branch& branch = tree_.branch(number);
      return known_in_[number] < branch.end_cell - branch.first_cell && empty.meets(square);
    };
    tree_.for_each_cell(is_asked_for, [&](std::uint32_t cell) {
      is_lacking_ = true;
      if (overlap(tree_.square(tree_.cell(cell)), near)) learn(cell);
    });
  }

  const QuadTree& tree_;
  const QuadTree::Branch& tile_;
  Square square_;
  std::int32_t reach_ = 0;  // up to twice as far from the tile is near
  std::vector<bool> is_known_;
  std::vector<std::uint32_t> known_;
  std::vector<std::uint32_t> known_in_;  // of each branch, how many of its cells
  bool is_lacking_ = false;              // something that a triangle needs was not known
};

}  // namespace

TileReport keep_tile(const QuadTree& tree, const QuadTree::Branch& tile, int meshes_max,
                     const std::function<void(const Corners&)>& tell) {
  Member member(tree, tile);
  TileReport report;
  report.is_final = tile.size() == 0;
  std::vector<Corners> own;
  while (!report.is_final && report.meshes < meshes_max) {
    ++report.meshes;
    report.own = {};
    own.clear();
    report.is_final = member.make_mesh([&](const Corners& corners) {
      report.own.add(corners);
      if (tell) own.push_back(corners);
    });
  }
  if (tell) std::for_each(own.begin(), own.end(), tell);
  member.report(report);
  return report;
}

}  // namespace etcm::bench
