// Every set of up to six nodes on a 4 x 4 grid: rich in collinear and cocircular nodes, and small
// enough that nothing is left to chance.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <set>
#include <vector>

#include "support/emulated.h"
#include "support/meshes.h"
#include "support/oracle.h"

namespace etcm::test {
namespace {

constexpr std::int32_t side = 4;
constexpr std::uint32_t sets = 1u << (side * side);

std::size_t size_of(std::uint32_t set) { return static_cast<std::size_t>(__builtin_popcount(set)); }

std::vector<Position> nodes_of(std::uint32_t set) {
  std::vector<Position> nodes;
  for (std::int32_t i = 0; i < side * side; ++i) {
    if ((set >> i & 1u) != 0) nodes.push_back({i % side, i / side});
  }
  return nodes;
}

// One set stands for all eight turned and mirrored ones.
bool is_least_of_its_images(std::uint32_t set) {
  for (int image = 1; image < 8; ++image) {
    std::uint32_t mapped = 0;
    for (const Position node : nodes_of(set)) {
      std::int32_t x = (image & 1) != 0 ? side - 1 - node.x : node.x;
      std::int32_t y = (image & 2) != 0 ? side - 1 - node.y : node.y;
      if ((image & 4) != 0) std::swap(x, y);
      mapped |= 1u << (y * side + x);
    }
    if (mapped < set) return false;
  }
  return true;
}

// The mesh of the nodes in every order, reached by joining and leaving: each order is a path.
class EveryOrder {
 public:
  EveryOrder(Mesh& mesh, std::vector<Position> nodes) : mesh_(mesh), nodes_(std::move(nodes)) {}

  // Every hash that a complete mesh had.
  const std::set<std::uint64_t>& run() {
    extend(0);
    return hashes_;
  }

 private:
  void extend(std::size_t joined) {
    if (joined == nodes_.size()) {
      hashes_.insert(mesh_.hash());
      return;
    }
    for (std::size_t next = joined; next < nodes_.size(); ++next) {
      std::swap(nodes_[joined], nodes_[next]);
      VertexId id;
      ASSERT_EQ(mesh_.join(nodes_[joined], id), Status::ok);
      extend(joined + 1);
      ASSERT_EQ(mesh_.leave(id), Status::ok);
      std::swap(nodes_[joined], nodes_[next]);
    }
  }

  Mesh& mesh_;
  std::vector<Position> nodes_;
  std::set<std::uint64_t> hashes_;
};

std::uint64_t hash_of_batch(const std::vector<Position>& nodes) {
  const auto mesh = built({"", nodes, {}});
  return (*mesh)->hash();
}

// The sets of so many nodes; under an emulator some of them.
std::vector<std::uint32_t> sets_of(std::size_t size, bool up_to_symmetry) {
  std::vector<std::uint32_t> found;
  int seen = 0;
  for (std::uint32_t set = 0; set < sets; ++set) {
    if (size_of(set) != size || (up_to_symmetry && !is_least_of_its_images(set))) continue;
    if (seen++ % thinning_if_slow == 0) found.push_back(set);
  }
  return found;
}

void expect_one_mesh_in_every_order(std::size_t size, bool up_to_symmetry) {
  const auto mesh = empty_mesh(8, 0);
  std::set<std::uint64_t> all;
  const std::vector<std::uint32_t> tried = sets_of(size, up_to_symmetry);
  for (const std::uint32_t set : tried) {
    const std::vector<Position> nodes = nodes_of(set);
    const std::set<std::uint64_t> hashes = EveryOrder(**mesh, nodes).run();
    ASSERT_EQ((*mesh)->node_count(), 0u);
    ASSERT_EQ(hashes, std::set{hash_of_batch(nodes)}) << "set " << set;
    all.insert(hashes.begin(), hashes.end());
  }
  EXPECT_EQ(all.size(), tried.size()) << "two sets with one hash";
}

TEST(SmallSets, PassTheOracle) {
  for (std::size_t size = 0; size <= 6; ++size) {
    for (const std::uint32_t set : sets_of(size, true)) {
      const auto mesh = grown({"", nodes_of(set), {}});
      ASSERT_TRUE(is_sound(**mesh)) << "set " << set;
    }
  }
}

TEST(SmallSets, OfUpToFiveAreOneMeshInEveryOrder) {
  for (std::size_t size = 0; size <= 5; ++size) expect_one_mesh_in_every_order(size, false);
}

TEST(SmallSets, OfSixAreOneMeshInEveryOrder) { expect_one_mesh_in_every_order(6, true); }

// Every pair of nodes as a feature, in every set of five up to symmetry: legal, or refused with the
// right word and nothing changed.
TEST(SmallSets, TakeEveryPairOfFeatures) {
  for (const std::uint32_t set : sets_of(5, true)) {
    const Graph nodes{"", nodes_of(set), {}};
    for (std::size_t i = 0; i < 10; ++i) {
      for (std::size_t j = 0; j < 10; ++j) {
        constexpr std::array<std::array<std::size_t, 2>, 10> pairs{
            {{0, 1}, {0, 2}, {0, 3}, {0, 4}, {1, 2}, {1, 3}, {1, 4}, {2, 3}, {2, 4}, {3, 4}}};
        const auto mesh = grown(nodes);
        FeatureId id;
        ASSERT_EQ((*mesh)->add_feature(between_nodes(pairs[i][0], pairs[i][1]), id), Status::ok);
        const Picture before = picture_of(**mesh);
        const Status second = (*mesh)->add_feature(between_nodes(pairs[j][1], pairs[j][0]), id);
        ASSERT_EQ(second == Status::repeated_feature, i == j);
        ASSERT_TRUE(second == Status::ok || picture_of(**mesh) == before) << to_string(second);
        ASSERT_TRUE(is_sound(**mesh)) << "set " << set << ", features " << i << " and " << j;
        if (second != Status::ok) continue;
        const auto other_way = built(
            {"",
             nodes.nodes,
             {between_nodes(pairs[j][0], pairs[j][1]), between_nodes(pairs[i][1], pairs[i][0])}});
        ASSERT_EQ((*mesh)->rebuild(), Status::ok);
        ASSERT_EQ((*mesh)->hash(), (*other_way)->hash())
            << "set " << set << ", features " << i << " and " << j;
      }
    }
  }
}

}  // namespace
}  // namespace etcm::test
