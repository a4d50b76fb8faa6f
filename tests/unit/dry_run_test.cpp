// A dry run answers what the change would, and leaves no trace.
#include "etcm/dry_run.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "inputs/random.h"
#include "support/meshes.h"

namespace etcm::test {
namespace {

// A line of nodes close to where a feature can run.
class DryRunTest : public testing::Test {
 protected:
  DryRunTest() : owned_(empty_mesh(60, 4)) {
    Graph graph{"", {{0, 0}, {1024, 0}, {0, 200}, {1024, 200}}, {between_nodes(0, 1)}};
    for (std::int32_t i = 1; i < 16; ++i) graph.nodes.push_back({64 * i, i % 2 == 0 ? 5 : -5});
    EXPECT_EQ(mesh().build(graph.nodes, graph.features), Status::ok);
  }

  Mesh& mesh() { return **owned_; }

  // What is asked leaves everything as it is.
  template <class Ask>
  Outcome asked(Ask ask) {
    const Picture before = picture_of(mesh());
    const ErrorDetail detail = mesh().error_detail();
    const Work work = mesh().work_needed();
    const std::uint32_t vertex_end = mesh().vertex_id_end(), feature_end = mesh().feature_id_end();
    const bool is_canonical = mesh().is_canonical();
    DryRun dry(mesh());
    const Outcome outcome = ask(dry);
    EXPECT_EQ(picture_of(mesh()), before);
    EXPECT_EQ(mesh().error_detail().status, detail.status);
    EXPECT_EQ(mesh().error_detail().vertex, detail.vertex);
    EXPECT_EQ(mesh().work_needed(), work);
    EXPECT_EQ(mesh().vertex_id_end(), vertex_end);
    EXPECT_EQ(mesh().feature_id_end(), feature_end);
    EXPECT_EQ(mesh().is_canonical(), is_canonical);
    return outcome;
  }

  std::unique_ptr<OwnedMesh> owned_;
};

TEST_F(DryRunTest, SaysHowManySteinerVerticesAFeatureWouldNeed) {
  ASSERT_TRUE(mesh().is_canonical());
  const FeatureEnds ends = between_nodes(2, 1);
  const Outcome outcome = asked([&](DryRun& dry) { return dry.add_feature(ends); });
  EXPECT_EQ(outcome.status, Status::ok);
  EXPECT_EQ(outcome.detail.status, Status::ok);
  EXPECT_GT(outcome.steiner, 0);
  const std::uint32_t before = mesh().steiner_count();
  FeatureId id;
  ASSERT_EQ(mesh().add_feature(ends, id), Status::ok);
  EXPECT_EQ(mesh().steiner_count(), before + static_cast<std::uint32_t>(outcome.steiner));
}

TEST_F(DryRunTest, SaysHowManySteinerVerticesWouldGo) {
  const Outcome outcome = asked([](DryRun& dry) { return dry.remove_feature(FeatureId{0}); });
  EXPECT_EQ(outcome.status, Status::ok);
  EXPECT_EQ(outcome.steiner, -static_cast<std::int32_t>(mesh().steiner_count()));
}

TEST_F(DryRunTest, AnswersAsTheChangeWould) {
  VertexId id;
  for (const Position position : {Position{512, 1}, Position{512, 0}, Position{64, -5},
                                  Position{5000, 5000}, Position{position_max + 1, 0}}) {
    const Outcome outcome = asked([&](DryRun& dry) { return dry.join(position); });
    const std::uint32_t before = mesh().steiner_count();
    EXPECT_EQ(outcome.status, mesh().join(position, id)) << testing::PrintToString(position);
    EXPECT_EQ(mesh().steiner_count(), before + static_cast<std::uint32_t>(outcome.steiner));
    EXPECT_EQ(outcome.detail.status, mesh().error_detail().status);
    EXPECT_EQ(outcome.detail.vertex, mesh().error_detail().vertex);
  }
}

TEST_F(DryRunTest, OfAMoveFollowsTheFeaturesOfTheNode) {
  const VertexId end = vertex_of(1);
  for (const Position position : {Position{1024, 0}, Position{1024, 40}, Position{0, 0}}) {
    const Outcome outcome = asked([&](DryRun& dry) { return dry.move(end, position); });
    const std::uint32_t before = mesh().steiner_count();
    EXPECT_EQ(outcome.status, mesh().move(end, position)) << testing::PrintToString(position);
    EXPECT_EQ(mesh().steiner_count(), before + static_cast<std::uint32_t>(outcome.steiner));
  }
}

TEST_F(DryRunTest, OfALeaveSaysWhetherTheNodeMay) {
  EXPECT_EQ(asked([](DryRun& dry) { return dry.leave(vertex_of(0)); }).status,
            Status::endpoint_in_use);
  EXPECT_EQ(asked([](DryRun& dry) { return dry.leave(vertex_of(5)); }).status, Status::ok);
  EXPECT_EQ(asked([](DryRun& dry) { return dry.leave(vertex_of(500)); }).status,
            Status::unknown_vertex);
}

TEST_F(DryRunTest, SaysThatThereIsNoRoom) {
  const std::unique_ptr<OwnedMesh> owned = empty_mesh(4, 1);
  Mesh& full = **owned;
  for (const Position position :
       {Position{0, 0}, Position{9, 0}, Position{4, 1}, Position{4, -1}}) {
    VertexId id;
    ASSERT_EQ(full.join(position, id), Status::ok);
  }
  const Outcome outcome = DryRun(full).add_feature(between_nodes(0, 1));
  EXPECT_EQ(outcome.status, Status::out_of_vertices);
  EXPECT_EQ(outcome.steiner, 0);
  EXPECT_EQ(outcome.detail.feature, FeatureId::none());
  EXPECT_EQ(full.error_detail().status, Status::ok);
}

TEST_F(DryRunTest, KeepsToItsLimitOfWork) {
  const Position position{512, 1};
  const Work needed = asked([&](DryRun& dry) { return dry.join(position); }).work;
  for (std::uint64_t units = 1; units < needed.units; units += 1 + needed.units / 40) {
    const Outcome outcome = asked([&](DryRun& dry) { return dry.join(position, Work{units}); });
    EXPECT_LE(outcome.work.units, units);
    if (outcome.status != Status::ok) {
      EXPECT_EQ(outcome.status, Status::work_limit);
    }
  }
}

// The dry run arranges the storage otherwise, so the change may take more than it said: not much.
TEST(WorkAfterADryRun, IsAtMostAQuarterMore) {
  std::uint32_t short_of = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const auto owned = empty_mesh(600, 60);
    Mesh& mesh = **owned;
    inputs::Random random(seed);
    const std::int32_t side = seed % 3 == 0 ? 60 : 1000;
    std::vector<VertexId> nodes;
    const auto one_of_them = [&] { return nodes[random.index(nodes.size())]; };
    const auto make = [&](const Outcome& foretold, const auto& change) {
      if (foretold.status != Status::ok) return false;
      if (change(foretold.work) == Status::ok) return true;
      ++short_of;
      const Status status = change(Work{foretold.work.units + foretold.work.units / 4});
      EXPECT_EQ(status, Status::ok) << "seed " << seed << ", " << foretold.work.units << " units";
      return status == Status::ok;
    };
    for (int step = 0; step < 200; ++step) {
      const Position place{random.between(0, side), random.between(0, side)};
      const std::uint64_t kind = nodes.size() < 3 ? 0 : random.below(10);
      VertexId node;
      FeatureId feature;
      if (kind < 4) {
        if (make(DryRun(mesh).join(place),
                 [&](Work limit) { return mesh.join(place, node, limit); })) {
          nodes.push_back(node);
        }
      } else if (kind < 7) {
        node = one_of_them();
        make(DryRun(mesh).move(node, place),
             [&](Work limit) { return mesh.move(node, place, limit); });
      } else {
        const FeatureEnds ends{one_of_them(), one_of_them()};
        make(DryRun(mesh).add_feature(ends),
             [&](Work limit) { return mesh.add_feature(ends, feature, limit); });
      }
    }
  }
  EXPECT_GT(short_of, 0u) << "then it is what the change takes";
}

}  // namespace
}  // namespace etcm::test
