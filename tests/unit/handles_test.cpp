// A handle of what has gone is an error, and never the name of another.
#include "etcm/handles.h"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <memory>
#include <vector>

#include "inputs/random.h"
#include "support/meshes.h"

namespace etcm::test {
namespace {

constexpr std::uint32_t most = std::numeric_limits<std::uint32_t>::max();

class HandlesTest : public testing::Test {
 protected:
  HandlesTest() : owned_(empty_mesh(200, 20)), storage_(Handles::words(mesh().config())) {
    EXPECT_EQ(handles_.open(mesh(), storage_), Status::ok);
  }

  Mesh& mesh() { return **owned_; }

  NodeHandle joined(Position position) {
    NodeHandle node;
    EXPECT_EQ(handles_.join(position, node), Status::ok);
    return node;
  }
  Status find(NodeHandle node) {
    VertexId id;
    return handles_.find(node, id);
  }
  Status find(FeatureHandle feature) {
    FeatureId id;
    return handles_.find(feature, id);
  }

  std::unique_ptr<OwnedMesh> owned_;
  std::vector<std::uint32_t> storage_;
  Handles handles_;
};

TEST_F(HandlesTest, AHandleOfANodeThatLeftIsStaleWhoeverHasItsId) {
  const NodeHandle first = joined({1, 1});
  ASSERT_EQ(handles_.leave(first), Status::ok);
  EXPECT_EQ(find(first), Status::stale_handle);
  const NodeHandle second = joined({2, 2});
  ASSERT_EQ(second.id, first.id);
  EXPECT_EQ(handles_.move(first, {9, 9}), Status::stale_handle);
  EXPECT_EQ(handles_.leave(first), Status::stale_handle);
  EXPECT_EQ(mesh().position(second.id), (Position{2, 2}));
  EXPECT_EQ(handles_.move(second, {3, 3}), Status::ok);
  EXPECT_EQ(mesh().position(second.id), (Position{3, 3}));
}

TEST_F(HandlesTest, AHandleOfAFeatureThatWasRemovedIsStaleWhoeverHasItsId) {
  const NodeHandle a = joined({0, 0}), b = joined({9, 0}), c = joined({0, 9});
  FeatureHandle first, second;
  ASSERT_EQ(handles_.add_feature(a, b, first), Status::ok);
  ASSERT_EQ(handles_.remove_feature(first), Status::ok);
  ASSERT_EQ(handles_.add_feature(b, c, second), Status::ok);
  ASSERT_EQ(second.id, first.id);
  EXPECT_EQ(handles_.remove_feature(first), Status::stale_handle);
  EXPECT_EQ(find(second), Status::ok);
  EXPECT_EQ(handles_.leave(a), Status::ok);
  EXPECT_EQ(handles_.add_feature(a, c, first), Status::stale_handle);
}

TEST_F(HandlesTest, ASteinerVertexWithTheIdOfANodeThatLeftHasNoHandle) {
  std::vector<NodeHandle> nodes;
  for (std::int32_t i = 0; i < 20; ++i) nodes.push_back(joined({10 * i, i % 2 == 0 ? 3 : -3}));
  const NodeHandle from = joined({-10, 0}), to = joined({210, 0});
  const NodeHandle gone = nodes[5];
  ASSERT_EQ(handles_.leave(gone), Status::ok);
  FeatureHandle feature;
  ASSERT_EQ(handles_.add_feature(from, to, feature), Status::ok);
  ASSERT_EQ(mesh().kind(gone.id), VertexKind::steiner);
  EXPECT_EQ(find(gone), Status::stale_handle);
  NodeHandle handle;
  EXPECT_EQ(handles_.handle_of(gone.id, handle), Status::unknown_vertex);
}

TEST_F(HandlesTest, LayingTheMeshAgainKeepsHandles) {
  std::vector<NodeHandle> nodes;
  for (std::int32_t i = 0; i < 20; ++i) nodes.push_back(joined({10 * i, i % 2 == 0 ? 3 : -3}));
  FeatureHandle feature;
  ASSERT_EQ(handles_.add_feature(joined({-10, 0}), joined({210, 0}), feature), Status::ok);
  ASSERT_EQ(handles_.leave(nodes[0]), Status::ok);
  EXPECT_EQ(mesh().canonicalize(), Status::ok);
  EXPECT_EQ(mesh().optimise(20), Status::ok);
  EXPECT_EQ(mesh().rebuild(), Status::ok);
  EXPECT_EQ(mesh().move(nodes[1].id, {15, 7}), Status::ok);
  EXPECT_EQ(find(nodes[0]), Status::stale_handle);
  for (std::size_t i = 1; i < nodes.size(); ++i) EXPECT_EQ(find(nodes[i]), Status::ok);
  EXPECT_EQ(find(feature), Status::ok);
}

TEST_F(HandlesTest, WhoComesWithoutTheHandlesKnowingMakesAllStale) {
  const NodeHandle a = joined({0, 0}), b = joined({9, 0});
  VertexId id;
  ASSERT_EQ(mesh().leave(a.id), Status::ok);
  EXPECT_EQ(find(a), Status::stale_handle);
  EXPECT_EQ(find(b), Status::ok);
  ASSERT_EQ(mesh().join({5, 5}, id), Status::ok);
  ASSERT_EQ(id, a.id);
  EXPECT_EQ(find(a), Status::stale_handle);
  EXPECT_EQ(find(b), Status::stale_handle);
  NodeHandle again;
  ASSERT_EQ(handles_.handle_of(b.id, again), Status::ok);
  EXPECT_NE(again, b);
  EXPECT_EQ(find(again), Status::ok);
  EXPECT_EQ(find(a), Status::stale_handle);
  EXPECT_EQ(find(b), Status::stale_handle);
}

TEST_F(HandlesTest, ARefusedChangeLeavesHandlesAsTheyAre) {
  const NodeHandle a = joined({0, 0}), b = joined({9, 0});
  NodeHandle none;
  VertexId id;
  EXPECT_EQ(handles_.join({9, 0}, none), Status::duplicate_vertex);
  EXPECT_EQ(mesh().join({9, 0}, id), Status::duplicate_vertex);
  EXPECT_EQ(handles_.join({4, 4}, none, Work{1}), Status::work_limit);
  EXPECT_EQ(none, NodeHandle{});
  EXPECT_EQ(find(a), Status::ok);
  EXPECT_EQ(find(b), Status::ok);
  EXPECT_EQ(handles_.given_out(), 2u);
}

TEST_F(HandlesTest, AMeshThatIsLoadedHasOtherHandles) {
  const NodeHandle node = joined({5, 5});
  std::vector<std::byte> saved(mesh().saved_bytes());
  ASSERT_EQ(mesh().save(saved), Status::ok);
  ASSERT_EQ(mesh().leave(node.id), Status::ok);
  ASSERT_EQ(mesh().load(saved), Status::ok);
  EXPECT_EQ(mesh().kind(node.id), VertexKind::node);
  EXPECT_EQ(find(node), Status::stale_handle);
}

TEST_F(HandlesTest, AMeshMadeAnewHasOtherHandles) {
  const std::vector<Position> nodes{{0, 0}, {9, 0}, {0, 9}};
  const std::vector<FeatureEnds> features{between_nodes(0, 1)};
  NodeHandle before = joined({5, 5});
  for (int time = 0; time < 4; ++time) {
    mesh().clear();
    EXPECT_EQ(find(before), Status::stale_handle);
    ASSERT_EQ(time % 2 == 0 ? mesh().build(nodes, features) : mesh().restore(nodes, features, {}),
              Status::ok);
    EXPECT_EQ(find(before), Status::stale_handle);
    NodeHandle after, same;
    ASSERT_EQ(handles_.handle_of(before.id, after), Status::ok);
    ASSERT_EQ(handles_.handle_of(before.id, same), Status::ok);
    EXPECT_EQ(after, same);
    EXPECT_NE(after, before);
    EXPECT_EQ(find(before), Status::stale_handle);
    before = after;
    FeatureHandle feature;
    EXPECT_EQ(handles_.handle_of(FeatureId{0}, feature), Status::ok);
    EXPECT_EQ(handles_.handle_of(FeatureId{1}, feature), Status::unknown_feature);
  }
}

TEST_F(HandlesTest, NoHandleNamesWhatIsNoNode) {
  joined({0, 0});
  VertexId id;
  for (const IdValue value : {IdValue{0}, IdValue{7}, IdValue{200}, VertexId::none_value}) {
    for (const std::uint32_t number : {0u, 1u, most}) {
      EXPECT_EQ(handles_.find(NodeHandle{VertexId{value}, number}, id), Status::stale_handle);
      EXPECT_EQ(find(FeatureHandle{FeatureId{value}, number}), Status::stale_handle);
    }
    NodeHandle node;
    EXPECT_EQ(handles_.handle_of(VertexId{value}, node), Status::unknown_vertex);
  }
  EXPECT_EQ(find(NodeHandle{}), Status::stale_handle);
  EXPECT_EQ(find(FeatureHandle{}), Status::stale_handle);
}

TEST_F(HandlesTest, NoNumberIsGivenTwice) {
  ASSERT_EQ(handles_.open(mesh(), storage_, most - 2), Status::ok);
  const NodeHandle a = joined({0, 0});
  const NodeHandle b = joined({9, 0});
  EXPECT_EQ(b.number, most);
  NodeHandle none;
  FeatureHandle feature;
  EXPECT_EQ(handles_.join({4, 4}, none), Status::out_of_handles);
  EXPECT_EQ(handles_.add_feature(a, b, feature), Status::out_of_handles);
  EXPECT_EQ(mesh().node_count(), 2u);
  EXPECT_EQ(mesh().feature_count(), 0u);
  // Those that are out still do.
  EXPECT_EQ(handles_.move(a, {1, 1}), Status::ok);
  EXPECT_EQ(handles_.leave(a), Status::ok);
  EXPECT_EQ(handles_.join({4, 4}, none), Status::out_of_handles);
  EXPECT_EQ(find(b), Status::ok);
  VertexId id;
  ASSERT_EQ(mesh().join({4, 4}, id), Status::ok);
  EXPECT_EQ(handles_.handle_of(id, none), Status::out_of_handles);
  EXPECT_EQ(find(b), Status::stale_handle);
  FeatureId line;
  ASSERT_EQ(mesh().add_feature({b.id, id}, line), Status::ok);
  EXPECT_EQ(handles_.handle_of(line, feature), Status::out_of_handles);
}

TEST_F(HandlesTest, OpenedAnewTheyKnowNobody) {
  const NodeHandle a = joined({0, 0});
  ASSERT_EQ(handles_.open(mesh(), storage_, handles_.given_out()), Status::ok);
  EXPECT_EQ(find(a), Status::stale_handle);
  NodeHandle again;
  ASSERT_EQ(handles_.handle_of(a.id, again), Status::ok);
  EXPECT_NE(again, a);
  Handles small;
  EXPECT_EQ(small.open(mesh(), std::span(storage_).first(storage_.size() - 1)),
            Status::storage_too_small);
}

TEST_F(HandlesTest, TwoOfOneMeshMakeEachOthersStale) {
  std::vector<std::uint32_t> storage(storage_.size());
  Handles other;
  const NodeHandle a = joined({0, 0});
  ASSERT_EQ(other.open(mesh(), storage), Status::ok);
  EXPECT_EQ(find(a), Status::stale_handle);
}

// Against a list of all handles that ever were.
TEST_F(HandlesTest, AreRightWhateverTheHistory) {
  inputs::Random random(3);
  std::map<NodeHandle, Position> standing;
  std::vector<NodeHandle> gone;
  for (int step = 0; step < 5000; ++step) {
    const Position position{random.between(0, 40), random.between(0, 40)};
    const bool is_unseen = random.below(50) == 0;
    NodeHandle node;
    VertexId id;
    if (random.below(2) == 0) {
      if (is_unseen) {
        if (mesh().join(position, id) == Status::ok) {
          for (const auto& [handle, where] : standing) gone.push_back(handle);
          standing.clear();
        }
      } else if (handles_.join(position, node) == Status::ok) {
        ASSERT_TRUE(standing.emplace(node, position).second);
      }
    } else if (!standing.empty()) {
      node = std::next(standing.begin(), static_cast<std::ptrdiff_t>(random.index(standing.size())))
                 ->first;
      const Status status = is_unseen ? mesh().leave(node.id) : handles_.leave(node);
      ASSERT_EQ(status, Status::ok);
      standing.erase(node);
      gone.push_back(node);
    } else if (mesh().node_count() > 100) {
      mesh().clear();
    }
    for (const auto& [handle, where] : standing) {
      ASSERT_EQ(handles_.find(handle, id), Status::ok);
      ASSERT_EQ(mesh().position(id), where);
    }
    for (int i = 0; i < 20 && !gone.empty(); ++i) {
      ASSERT_EQ(find(gone[random.index(gone.size())]), Status::stale_handle);
    }
  }
  EXPECT_GT(gone.size(), 1000u);
}

}  // namespace
}  // namespace etcm::test
