// Every capacity below what a run needs: each is answered with its own word, and nothing changes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "inputs/random_graph.h"
#include "support/emulated.h"
#include "support/mesh_block.h"
#include "support/meshes.h"
#include "support/oracle.h"

namespace etcm::test {
namespace {

// A mesh on its way through the script. Nodes are counted in order of joining: which ids they get
// depends on the Steiner vertices before them.
struct Run {
  Mesh& mesh;
  Work limit = Work::unlimited();  // of each call
  std::vector<VertexId> nodes{};
  std::vector<FeatureId> features{};

  Status join(Position position) {
    nodes.emplace_back();
    return mesh.join(position, nodes.back(), limit);
  }
  Status add_feature(std::size_t from, std::size_t to) {
    features.emplace_back();
    return mesh.add_feature({nodes[from], nodes[to]}, features.back(), limit);
  }
};

// Uses every call that needs room: nodes, long features, a node on a feature, moves of nodes and of
// ends, a leave that leaves a feature bare.
std::vector<std::function<Status(Run&)>> script() {
  std::vector<std::function<Status(Run&)>> calls;
  const auto join = [&calls](Position position) {
    calls.emplace_back([position](Run& run) { return run.join(position); });
  };
  const auto feature = [&calls](std::size_t from, std::size_t to) {
    calls.emplace_back([from, to](Run& run) { return run.add_feature(from, to); });
  };
  const auto move = [&calls](std::size_t node, Position position) {
    calls.emplace_back(
        [node, position](Run& run) { return run.mesh.move(run.nodes[node], position, run.limit); });
  };
  join({0, 0});
  join({1000, 0});
  for (std::int32_t i = 0; i < 12; ++i) join({40 + 75 * i, i % 2 == 0 ? 9 + i : -8 - i});
  feature(0, 1);
  join({500, 0});
  for (std::int32_t i = 1; i < 4; ++i) join({i * 10, 300 + i});
  feature(2, 15);
  feature(12, 16);
  move(14, {501, 3});
  move(4, {300, 290});
  calls.emplace_back([](Run& run) { return run.mesh.leave(run.nodes[5], run.limit); });
  move(1, {1100, -70});
  calls.emplace_back([](Run& run) { return run.mesh.remove_feature(run.features[1], run.limit); });
  join({620, -1});
  return calls;
}

struct Need {
  std::uint32_t vertices = 0;
  std::uint32_t steiner = 0;
};

Need need_of_good_run() {
  const auto mesh = empty_mesh(2000, 100);
  Need need;
  Run run{**mesh};
  int call = 0;
  for (const auto& change : script()) {
    EXPECT_EQ(change(run), Status::ok) << "call " << call;
    ++call;
    EXPECT_TRUE(is_sound(**mesh));
    need.vertices = std::max(need.vertices, (*mesh)->node_count() + (*mesh)->steiner_count());
    need.steiner = std::max(need.steiner, (*mesh)->steiner_count());
  }
  return need;
}

// Runs the script in a mesh that is too small until the first refusal for want of room.
Status first_refusal(const MeshConfig& config, Work limit = Work::unlimited()) {
  OwnedMesh mesh(config);
  EXPECT_EQ(mesh.opened(), Status::ok);
  Run run{*mesh, limit};
  for (const auto& change : script()) {
    const Picture before = picture_of(*mesh);
    const Status answer = change(run);
    if (answer == Status::ok) continue;
    EXPECT_EQ(picture_of(*mesh), before) << to_string(answer);
    EXPECT_EQ(mesh->error_detail().status, answer);
    EXPECT_TRUE(is_sound(*mesh)) << to_string(answer);
    return answer;
  }
  return Status::ok;
}

TEST(Capacity, OfVerticesMayBeAnything) {
  const Need need = need_of_good_run();
  ASSERT_GT(need.steiner, 5u);
  for (std::uint32_t vertices = 1; vertices < need.vertices; ++vertices) {
    MeshConfig config;
    config.vertices_max = vertices;
    config.features_max = 100;
    EXPECT_EQ(first_refusal(config), Status::out_of_vertices) << vertices << " vertices";
  }
}

TEST(Capacity, OfFeaturesMayBeAnything) {
  for (std::uint32_t features = 0; features < 4; ++features) {
    MeshConfig config;
    config.vertices_max = 2000;
    config.features_max = features;
    EXPECT_EQ(first_refusal(config), Status::out_of_features) << features << " features";
  }
}

// A feature that is laid again has the segments that it had.
TEST(Capacity, OfFeaturesIsThatOfAnEndThatMovesOverOtherNodesToo) {
  OwnedMesh mesh(MeshConfig{.vertices_max = 100, .features_max = 4});
  test::Run run{*mesh};
  for (std::int32_t i = 0; i < 6; ++i) ASSERT_EQ(run.join({10 * i, 0}), Status::ok);
  ASSERT_EQ(run.join({0, 100}), Status::ok);
  ASSERT_EQ(run.add_feature(0, 4), Status::ok);
  const Picture before = picture_of(*mesh);
  EXPECT_EQ(mesh->move(run.nodes[4], {55, 0}), Status::out_of_features);
  EXPECT_EQ(picture_of(*mesh), before);
  EXPECT_TRUE(is_sound(*mesh));
  EXPECT_EQ(mesh->move(run.nodes[4], {45, 0}), Status::ok);
  EXPECT_EQ(mesh->move(run.nodes[4], {25, 0}), Status::ok);
  EXPECT_EQ(mesh->move(run.nodes[4], {45, 0}), Status::ok);
  EXPECT_TRUE(is_sound(*mesh));
}

TEST(Capacity, OfSteinerVerticesMayBeAnything) {
  const Need need = need_of_good_run();
  for (std::uint32_t steiner = 1; steiner < need.steiner; ++steiner) {
    MeshConfig config;
    config.vertices_max = 2000;
    config.features_max = 100;
    config.steiner_max = steiner;
    EXPECT_EQ(first_refusal(config), Status::steiner_budget) << steiner << " Steiner vertices";
  }
}

TEST(Capacity, OfWorkMayBeAnything) {
  MeshConfig config{.vertices_max = 2000, .features_max = 100};
  bool refused = true;
  for (std::uint64_t units = 0; refused; units = units < 64 ? units + 1 : units + units / 16) {
    ASSERT_LT(units, 1'000'000u) << "no limit is enough";
    const Status answer = first_refusal(config, Work{units});
    EXPECT_TRUE(answer == Status::work_limit || answer == Status::ok) << to_string(answer);
    refused = answer != Status::ok;
  }
}

// Makes each call with each limit below what it needs, and then with that. Returns how many were
// too little. A refusal may leave walks another place to begin at, so the bytes are put back.
std::uint64_t refuse_each_limit(std::uint64_t step) {
  const MeshConfig config{.vertices_max = 400, .features_max = 40};
  MeshBlock block(config);
  EXPECT_EQ(block->open(block.bytes(), config), Status::ok);
  Run run{*block};
  std::uint64_t refusals = 0;
  for (const auto& change : script()) {
    const std::vector<std::byte> bytes(block.bytes().begin(), block.bytes().end());
    const Picture before = picture_of(*block);
    const auto change_within = [&](Work limit) {
      std::copy(bytes.begin(), bytes.end(), block.bytes().begin());
      Run attempt = run;
      attempt.limit = limit;
      return change(attempt);
    };
    Run unlimited = run;
    EXPECT_EQ(change(unlimited), Status::ok);
    const Work needed = block->work_needed();
    for (std::uint64_t units = 0; units < needed.units; units += step) {
      EXPECT_EQ(change_within(Work{units}), Status::work_limit) << units;
      EXPECT_TRUE(picture_of(*block) == before) << units;
      ++refusals;
    }
    EXPECT_TRUE(is_sound(*block));
    EXPECT_EQ(change_within(needed), Status::ok);
    run.nodes = unlimited.nodes;
    run.features = unlimited.features;
  }
  return refusals;
}

TEST(Capacity, OfWorkIsCheckedToTheUnit) {
  constexpr std::uint64_t step = is_emulated ? 37 : 1;
  EXPECT_GT(refuse_each_limit(step), 5000 / step);
}

// build() is the one call that may leave a partly conforming mesh, and it says so.
TEST(Capacity, OfBuildMayBeAnything) {
  const Graph graph = inputs::random_graph(60, inputs::FeatureLength::any, 3);
  const std::uint32_t steiner = (*built(graph))->steiner_count();
  ASSERT_GT(steiner, 5u);
  for (std::uint32_t room = 0; room < 60 + steiner; ++room) {
    MeshConfig config;
    config.vertices_max = std::max(room, 1u);
    config.features_max = 100;
    OwnedMesh mesh(config);
    ASSERT_EQ(mesh.opened(), Status::ok);
    EXPECT_EQ(mesh->build(graph.nodes, graph.features), Status::out_of_vertices) << room;
    if (room < 60) {
      EXPECT_EQ(mesh->node_count(), 0u) << room;
    } else {
      EXPECT_GT(mesh->unresolved(), 0u) << room;
      EXPECT_NE(mesh->error_detail().from, mesh->error_detail().to) << room;
    }
    mesh->clear();
    EXPECT_EQ(mesh->node_count(), 0u);
    EXPECT_TRUE(is_sound(*mesh));
  }
}

// What is laid of a feature when there are no more vertices is at one of its ends.
TEST(Capacity, OfBuildTellsHowManySubsegmentsAreMissing) {
  const Graph graph{"",
                    {{0, 0}, {1000, 0}, {250, 3}, {500, -4}, {750, 3}, {500, 300}},
                    {between_nodes(0, 1), between_nodes(0, 2)}};
  const auto nodes = static_cast<std::uint32_t>(graph.nodes.size());
  const std::uint32_t steiner = (*built(graph))->steiner_count();
  ASSERT_GT(steiner, 1u);
  for (std::uint32_t room = 0; room < steiner; ++room) {
    OwnedMesh mesh(MeshConfig{.vertices_max = nodes + room, .features_max = 4});
    ASSERT_EQ(mesh->build(graph.nodes, graph.features), Status::out_of_vertices);
    EXPECT_EQ(mesh->unresolved(), 1u) << room;
  }
}

TEST(Capacity, OfStorageIsCheckedToTheByte) {
  MeshConfig config;
  config.vertices_max = 10;
  config.features_max = 3;
  std::vector<std::uint64_t> storage(storage_bytes(config) / 8 + 2);
  const std::span<std::byte> bytes = std::as_writable_bytes(std::span(storage));
  Mesh mesh;
  EXPECT_EQ(mesh.open(bytes.first(storage_bytes(config) - 1), config), Status::storage_too_small);
  EXPECT_EQ(mesh.open(bytes.first(storage_bytes(config)), config), Status::ok);
}

}  // namespace
}  // namespace etcm::test
