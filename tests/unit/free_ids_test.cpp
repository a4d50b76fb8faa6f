// The least free id comes first, whatever the history.
#include "triangulation/free_ids.h"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <memory>
#include <set>
#include <vector>

#include "inputs/random.h"
#include "support/meshes.h"

namespace etcm::test {
namespace {

TEST(FreeIds, GivesOutTheLeastWhateverTheHistory) {
  inputs::Random random(1);
  for (const std::size_t ids : {1u, 2u, 7u, 100u, 3000u}) {
    std::vector<std::array<IdValue, 3>> storage(ids);
    const internal::FreeRecords records{reinterpret_cast<std::byte*>(storage.data()),
                                        sizeof storage[0]};
    internal::FreeIds free;
    std::set<IdValue> expected;
    for (int step = 0; step < 20'000; ++step) {
      const auto id = static_cast<IdValue>(random.index(ids));
      const bool grows = random.below(100) < (step % 4000 < 2000 ? 70u : 30u);
      if (grows && expected.insert(id).second) {
        free.add(records, id);
      } else if (!grows && !expected.empty()) {
        ASSERT_EQ(free.take(records), *expected.begin());
        expected.erase(expected.begin());
      }
      if (random.below(1000) == 0) {
        free.keep_below(records, id);
        expected.erase(expected.lower_bound(id), expected.end());
      }
      ASSERT_EQ(free.count(records), expected.size());
      ASSERT_EQ(free.is_empty(), expected.empty());
    }
  }
}

// The ways down are short: whoever comes in ascending or in descending order.
TEST(FreeIds, TakeManyInAnyOrder) {
  constexpr IdValue many = 4000;
  std::vector<std::array<IdValue, 3>> storage(many);
  const internal::FreeRecords records{reinterpret_cast<std::byte*>(storage.data()),
                                      sizeof storage[0]};
  for (const bool is_ascending : {true, false}) {
    internal::FreeIds free;
    for (IdValue i = 0; i < many; ++i) {
      free.add(records, is_ascending ? i : static_cast<IdValue>(many - 1 - i));
    }
    for (IdValue i = 0; i < many; ++i) ASSERT_EQ(free.take(records), i);
    EXPECT_TRUE(free.is_empty());
  }
}

VertexId least_free(const Mesh& mesh) {
  IdValue id = 1;
  while (id < mesh.vertex_id_end() && mesh.kind(VertexId{id}) != VertexKind::none) ++id;
  return VertexId{id};
}

TEST(FreeIds, NodesThatJoinTakeTheLeastOne) {
  const std::unique_ptr<OwnedMesh> owned = empty_mesh(200, 40);
  Mesh& mesh = **owned;
  inputs::Random random(2);
  std::vector<FeatureId> features;
  for (int step = 0; step < 3000; ++step) {
    const Position position{random.between(0, 300), random.between(0, 300)};
    const VertexId expected = least_free(mesh);
    const VertexId any{static_cast<IdValue>(1 + random.index(mesh.vertex_id_end()))};
    VertexId id;
    FeatureId feature;
    switch (random.below(4)) {
      case 0:
        static_cast<void>(mesh.leave(any));
        break;
      case 1:
        static_cast<void>(mesh.add_feature({any, VertexId{1}}, feature));
        break;
      case 2:
        static_cast<void>(mesh.remove_feature(FeatureId{static_cast<IdValue>(random.below(40))}));
        break;
      default:
        if (mesh.join(position, id) == Status::ok) {
          ASSERT_EQ(id, expected);
        }
    }
  }
  EXPECT_GT(mesh.feature_count(), 0u);
}

TEST(FreeIds, FeaturesTakeTheLeastOne) {
  const std::unique_ptr<OwnedMesh> owned = empty_mesh(50, 8);
  Mesh& mesh = **owned;
  std::vector<VertexId> nodes(6);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto at = static_cast<std::int32_t>(i);
    ASSERT_EQ(mesh.join({10 * at, at * at}, nodes[i]), Status::ok);
  }
  FeatureId id;
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    ASSERT_EQ(mesh.add_feature({nodes[i - 1], nodes[i]}, id), Status::ok);
    EXPECT_EQ(id, FeatureId{static_cast<IdValue>(i - 1)});
  }
  // In either order of removal.
  for (const IdValue first : {IdValue{1}, IdValue{3}}) {
    const FeatureEnds ends = mesh.ends(FeatureId{1});
    ASSERT_EQ(mesh.remove_feature(FeatureId{first}), Status::ok);
    ASSERT_EQ(mesh.remove_feature(FeatureId{static_cast<IdValue>(4 - first)}), Status::ok);
    ASSERT_EQ(mesh.add_feature(ends, id), Status::ok);
    EXPECT_EQ(id, FeatureId{1});
    ASSERT_EQ(mesh.add_feature({nodes[3], nodes[4]}, id), Status::ok);
    EXPECT_EQ(id, FeatureId{3});
  }
}

}  // namespace
}  // namespace etcm::test
