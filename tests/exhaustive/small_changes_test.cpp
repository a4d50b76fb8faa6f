// Every change of every small mesh: of each set of nodes on a small grid, with each legal set of up
// to three features, under both policies, each node that could join, leave or move, and each
// feature that could come or go. Each change is made of the mesh that build() makes, made
// canonical, and compared with what build() makes of the result; what build() refuses must be
// refused, and change nothing.
//
// A part is done each time. ETCM_EXHAUSTIVE=1 in the environment does all of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <ostream>
#include <unordered_map>
#include <utility>
#include <vector>

#include "etcm/audit.h"
#include "etcm/storage.h"
#include "support/emulated.h"
#include "support/mesh_block.h"
#include "support/meshes.h"

namespace etcm::test {
namespace {

// A node is named by the cell that it stands in, a feature by both, the lesser first.
using Cell = unsigned;
using CellPair = std::pair<Cell, Cell>;

struct SmallGraph {
  std::uint32_t cells = 0;  // a bit for each that a node stands in
  std::vector<CellPair> features;

  bool has(Cell cell) const { return (cells >> cell & 1u) != 0; }
  // Its index among the nodes.
  std::size_t index_of(Cell cell) const {
    return static_cast<std::size_t>(std::popcount(cells & ((1u << cell) - 1)));
  }
};

CellPair pair_of(Cell a, Cell b) { return {std::min(a, b), std::max(a, b)}; }

struct World {
  const char* name;
  Cell side;
  int nodes_most;
  SplitPolicy policy;
  unsigned thinning;  // of graphs with features one in so many is looked at
};

void PrintTo(const World& world, std::ostream* out) { *out << world.name; }

constexpr MeshConfig small_room{.vertices_max = 60, .features_max = 24};
constexpr int features_most = 3;
// Going over all graphs takes minutes where it is slow, whichever of them are looked at: of sets of
// nodes there is one in so many then.
constexpr unsigned sets_thinned = is_slow ? 4 : 1;
constexpr unsigned thinned = thinning_if_slow * sets_thinned;

class SmallChanges : public testing::TestWithParam<World> {
 protected:
  Cell cell_count() const { return GetParam().side * GetParam().side; }

  Position place(Cell cell) const {
    return {static_cast<std::int32_t>(cell % GetParam().side),
            static_cast<std::int32_t>(cell / GetParam().side)};
  }

  static std::uint64_t key_of(const SmallGraph& graph) {
    std::uint64_t key = graph.cells;
    std::vector<CellPair> sorted = graph.features;
    std::sort(sorted.begin(), sorted.end());
    for (const auto& [a, b] : sorted) key = key << 8 | a << 4 | b;
    return key << 3 | sorted.size();
  }

  Status build(Mesh& mesh, const SmallGraph& graph) const {
    std::vector<Position> nodes;
    for (Cell cell = 0; cell < cell_count(); ++cell) {
      if (graph.has(cell)) nodes.push_back(place(cell));
    }
    std::vector<FeatureEnds> features;
    for (const auto& [a, b] : graph.features) {
      features.push_back(between_nodes(graph.index_of(a), graph.index_of(b)));
    }
    return mesh.build(nodes, features);
  }

  // The hash of what build() makes of it; none where it refuses.
  std::optional<std::uint64_t> expected(const SmallGraph& graph) {
    const auto [found, is_new] = hashes_.try_emplace(key_of(graph));
    if (!is_new) return found->second;
    MeshBlock block(small_room);
    open(block);
    if (build(*block, graph) == Status::ok) found->second = block->hash();
    return found->second;
  }

  void open(MeshBlock& block) const {
    MeshConfig config = small_room;
    config.policy = GetParam().policy;
    ASSERT_EQ(block->open(block.bytes(), config), Status::ok);
  }

  void change_all(const SmallGraph& graph) {
    MeshBlock block(small_room);
    open(block);
    ASSERT_EQ(build(*block, graph), Status::ok);
    start_.assign(block.bytes().begin(), block.bytes().end());
    picture_ = picture_of(*block);
    change_nodes(block, graph);
    change_features(block, graph);
  }

  void change_nodes(MeshBlock& block, const SmallGraph& graph) {
    for (Cell to = 0; to < cell_count(); ++to) {
      if (graph.has(to)) continue;
      SmallGraph after = graph;
      after.cells |= 1u << to;
      VertexId id;
      judge(block, after, [&](Mesh& mesh) { return mesh.join(place(to), id); });
    }
    for (Cell cell = 0; cell < cell_count(); ++cell) {
      if (!graph.has(cell)) continue;
      const VertexId node = vertex_of(graph.index_of(cell));
      leave(block, graph, cell, node);
      for (Cell to = 0; to < cell_count(); ++to) {
        if (graph.has(to)) continue;
        SmallGraph after = graph;
        after.cells ^= 1u << cell | 1u << to;
        for (CellPair& f : after.features) {
          f = pair_of(f.first == cell ? to : f.first, f.second == cell ? to : f.second);
        }
        judge(block, after, [&](Mesh& mesh) { return mesh.move(node, place(to)); });
      }
    }
  }

  void leave(MeshBlock& block, const SmallGraph& graph, Cell cell, VertexId node) {
    const bool is_end =
        std::any_of(graph.features.begin(), graph.features.end(),
                    [cell](const CellPair& f) { return f.first == cell || f.second == cell; });
    SmallGraph after = graph;
    after.cells ^= 1u << cell;
    judge(
        block, after, [&](Mesh& mesh) { return mesh.leave(node); }, is_end);
  }

  void change_features(MeshBlock& block, const SmallGraph& graph) {
    for (Cell a = 0; a < cell_count(); ++a) {
      for (Cell b = a + 1; b < cell_count(); ++b) {
        if (!graph.has(a) || !graph.has(b)) continue;
        SmallGraph after = graph;
        after.features.emplace_back(a, b);
        FeatureId id;
        const FeatureEnds ends = between_nodes(graph.index_of(b), graph.index_of(a));
        judge(block, after, [&](Mesh& mesh) { return mesh.add_feature(ends, id); });
      }
    }
    for (std::size_t i = 0; i < graph.features.size(); ++i) {
      SmallGraph after = graph;
      after.features.erase(after.features.begin() + static_cast<std::ptrdiff_t>(i));
      const FeatureId id{static_cast<IdValue>(i)};
      judge(block, after, [&](Mesh& mesh) { return mesh.remove_feature(id); });
    }
  }

  template <class Ask>
  void judge(MeshBlock& block, const SmallGraph& after, Ask ask, bool must_refuse = false) {
    ++changes_;
    std::memcpy(block.bytes().data(), start_.data(), start_.size());
    Mesh& mesh = *block;
    const Status status = ask(mesh);
    const std::optional<std::uint64_t> hash =
        must_refuse ? std::optional<std::uint64_t>{} : expected(after);
    if (hash) {
      ASSERT_EQ(status, Status::ok) << "graph " << key_of(after);
      ASSERT_TRUE(audit(mesh)) << "graph " << key_of(after);
      ASSERT_EQ(mesh.canonicalize(), Status::ok);
      ASSERT_EQ(mesh.hash(), *hash) << "graph " << key_of(after);
    } else {
      ++refused_;
      ASSERT_NE(status, Status::ok) << "graph " << key_of(after);
      ASSERT_TRUE(picture_of(mesh) == picture_) << to_string(status);
    }
    ASSERT_TRUE(audit(mesh)) << "graph " << key_of(after);
  }

  // With each legal set of features from this pair of cells on.
  void extend(SmallGraph& graph, Cell from, bool is_all) {
    if (is_all || chosen(graph)) {
      ++graphs_;
      ASSERT_NO_FATAL_FAILURE(change_all(graph)) << "graph " << key_of(graph);
    }
    if (graph.features.size() == features_most) return;
    for (Cell code = from; code < cell_count() * cell_count(); ++code) {
      const Cell a = code / cell_count(), b = code % cell_count();
      if (a >= b || !graph.has(a) || !graph.has(b)) continue;
      graph.features.emplace_back(a, b);
      if (expected(graph)) extend(graph, code + 1, is_all);
      graph.features.pop_back();
      if (HasFatalFailure()) return;
    }
  }

  bool chosen(const SmallGraph& graph) const {
    const std::uint64_t scattered = key_of(graph) * 0x9e3779b97f4a7c15u;
    const unsigned one_in = graph.features.empty() ? 2 : GetParam().thinning;
    return (scattered >> 33) % (one_in * thinning_if_slow) == 0;
  }

  std::unordered_map<std::uint64_t, std::optional<std::uint64_t>> hashes_;
  std::vector<std::byte> start_;
  Picture picture_;
  std::uint64_t graphs_ = 0, changes_ = 0, refused_ = 0;
};

TEST_P(SmallChanges, MakeWhatBuildMakes) {
  const bool is_all = std::getenv("ETCM_EXHAUSTIVE") != nullptr;
  for (std::uint32_t cells = 0; cells < 1u << cell_count(); ++cells) {
    if (std::popcount(cells) > GetParam().nodes_most) continue;
    if ((cells * 0x9e3779b9u >> 20) % sets_thinned != 0) continue;
    SmallGraph graph{cells, {}};
    ASSERT_NO_FATAL_FAILURE(extend(graph, 0, is_all));
    // Other graphs have other sets of cells, but for changes of one node.
    if (hashes_.size() > 4'000'000) hashes_.clear();
  }
  RecordProperty("graphs", std::to_string(graphs_));
  RecordProperty("changes", std::to_string(changes_));
  EXPECT_GT(graphs_, 1000u / thinned);
  EXPECT_GT(refused_, 1000u / thinned);
}

INSTANTIATE_TEST_SUITE_P(Worlds, SmallChanges,
                         testing::Values(World{"of_seven_on_3_by_3", 3, 7, split_default, 40},
                                         World{"of_seven_on_3_by_3_paper", 3, 7, split_paper, 80},
                                         World{"of_five_on_4_by_4", 4, 5, split_default, 160},
                                         World{"of_five_on_4_by_4_paper", 4, 5, split_paper, 320}),
                         [](const testing::TestParamInfo<World>& world) {
                           return std::string(world.param.name);
                         });

}  // namespace
}  // namespace etcm::test
