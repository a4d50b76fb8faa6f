// Nodes with many neighbours leave, and the mesh is the one without them: wherever they stand among
// them, and whatever lies on one circle.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "inputs/direction.h"
#include "inputs/patterns.h"
#include "inputs/random.h"
#include "support/emulated.h"
#include "support/meshes.h"
#include "support/oracle.h"

namespace etcm::test {
namespace {

constexpr std::int32_t radius = 1'000'000;
constexpr std::size_t around = is_slow ? 60 : 700;

std::uint32_t degree_of(const Mesh& mesh, VertexId v) { return mesh.neighbours(v, {}); }

// Nodes around the origin over a part of a turn, up to `deviation` off a circle.
Graph arc(std::int32_t millidegrees, std::int32_t deviation, std::uint64_t seed) {
  inputs::Random random(seed);
  Graph graph{"arc", {}, {}};
  for (std::size_t i = 0; i < around; ++i) {
    const auto angle = static_cast<std::int32_t>(
        std::int64_t{millidegrees} * static_cast<std::int64_t>(i) / std::int64_t{around});
    graph.nodes.push_back(
        inputs::at_angle({0, 0}, angle, radius + random.between(-deviation, deviation)));
  }
  return graph;
}

Graph row(std::int32_t step, std::int32_t deviation) {
  inputs::Random random(1);
  Graph graph{"row", {}, {}};
  for (std::size_t i = 0; i < around; ++i) {
    graph.nodes.push_back({static_cast<std::int32_t>(i) * step, random.between(0, deviation)});
  }
  return graph;
}

void expect_hub_leaves(const Graph& surroundings, Position hub, std::uint32_t degree_min) {
  Graph graph = surroundings;
  graph.nodes.insert(graph.nodes.begin() + static_cast<std::ptrdiff_t>(graph.nodes.size() / 2),
                     hub);
  const VertexId v = vertex_of(surroundings.nodes.size() / 2);
  const auto mesh = built(graph);
  EXPECT_GE(degree_of(**mesh, v), degree_min);
  ASSERT_EQ((*mesh)->leave(v), Status::ok);
  EXPECT_TRUE(passes_audit(**mesh));
  EXPECT_EQ((*mesh)->hash(), (*built(surroundings))->hash());
}

constexpr std::uint32_t many = around / 20;

TEST(Hub, LeavesTheMiddleOfARing) {
  for (const std::int32_t deviation : {0, 1, 10}) {
    expect_hub_leaves(arc(inputs::full_turn_millidegrees, deviation, 1), {0, 0}, many);
    expect_hub_leaves(arc(inputs::full_turn_millidegrees, deviation, 2), {17, 170'000}, many);
  }
}

TEST(Hub, LeavesTheHull) {
  for (const std::int32_t turn : {30'000, 90'000, 180'000, 181'000, 240'000}) {
    expect_hub_leaves(arc(turn, 2, 3), {0, 0}, many);
  }
}

TEST(Hub, LeavesNodesOnOneLine) {
  expect_hub_leaves(row(10, 0), {50, 900'000}, around);
  expect_hub_leaves(row(10, 0), {-100, -900'000}, around);
  expect_hub_leaves(row(10, 1), {50, 9'000'000}, 3);
}

TEST(Hub, LeavesNodesOnOneCircle) {
  Graph circle = inputs::exact_circle(0, 1);
  expect_hub_leaves(circle, {0, 0}, 324);
  expect_hub_leaves(circle, {3, -1000}, many);
  // The upper half, so that it stands on the hull.
  std::erase_if(circle.nodes, [](Position p) { return p.y < 0; });
  expect_hub_leaves(circle, {0, -1}, 100);
}

TEST(Hub, OnTheCircleOfAllOthersLeaves) {
  Graph circle = inputs::exact_circle(0, 1);
  while (!circle.nodes.empty()) {
    const Position last = circle.nodes.back();
    circle.nodes.pop_back();
    if (circle.nodes.size() % 40 == 3) expect_hub_leaves(circle, last, 2);
  }
}

// Chords decide which of the ties is the mesh, also beside the star.
TEST(Hub, LeavesAmongFeatures) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Graph circle = inputs::exact_circle(40, seed);
    inputs::Random random(seed);
    const auto mesh = built(circle);
    VertexId hub;
    const Status status = (*mesh)->join({random.between(-9000, 9000), random.between(-9, 9)}, hub);
    if (status == Status::duplicate_vertex) continue;
    ASSERT_EQ(status, Status::ok);
    ASSERT_EQ((*mesh)->leave(hub), Status::ok);
    EXPECT_TRUE(passes_audit(**mesh));
    ASSERT_EQ((*mesh)->canonicalize(), Status::ok);
    EXPECT_EQ((*mesh)->hash(), (*built(circle))->hash()) << "seed " << seed;
  }
}

// The feature through it needs a Steiner vertex then, and there is no room.
TEST(Hub, ThatCannotLeaveStaysAsItWas) {
  Graph graph = arc(inputs::full_turn_millidegrees, 0, 1);
  std::erase_if(graph.nodes, [](Position p) { return p.x == 0; });
  graph.nodes.insert(graph.nodes.end(),
                     {{0, 0}, {radius / 2, 0}, {-radius / 2, 0}, {0, radius}, {0, -radius}});
  const std::size_t count = graph.nodes.size();
  graph.features.push_back(between_nodes(count - 2, count - 1));
  const VertexId hub = vertex_of(count - 5);
  const auto mesh = built(graph, split_default, 0);
  ASSERT_EQ((*mesh)->position(hub), (Position{0, 0}));
  EXPECT_GE(degree_of(**mesh, hub), many);
  const std::uint64_t hash = (*mesh)->hash();
  EXPECT_EQ((*mesh)->leave(hub), Status::out_of_vertices);
  EXPECT_TRUE(passes_audit(**mesh));
  EXPECT_EQ((*mesh)->hash(), hash);
}

// Features from the origin, the last node, to all of a ring.
Graph star(std::int32_t deviation) {
  Graph graph = arc(inputs::full_turn_millidegrees, deviation, 7);
  const std::size_t count = graph.nodes.size();
  graph.nodes.push_back({0, 0});
  for (std::size_t i = 0; i < count; ++i) graph.features.push_back(between_nodes(count, i));
  return graph;
}

TEST(Hub, WithManyFeaturesMoves) {
  for (const std::int32_t deviation : {0, 5, 50}) {
    Graph graph = star(deviation);
    const auto mesh = built(graph, split_default, 20'000);
    graph.nodes.back() = {101, -57};
    ASSERT_EQ((*mesh)->move(vertex_of(around), graph.nodes.back()), Status::ok);
    EXPECT_TRUE(passes_audit(**mesh));
    ASSERT_EQ((*mesh)->canonicalize(), Status::ok);
    EXPECT_EQ((*mesh)->hash(), (*built(graph, split_default, 20'000))->hash()) << deviation;
  }
}

TEST(Hub, LosesItsFeaturesInAnyOrder) {
  Graph graph = star(radius / 1000);
  const auto mesh = built(graph, split_default, 20'000);
  std::vector<IdValue> order;
  for (std::size_t i = 0; i < around; ++i) order.push_back(static_cast<IdValue>(i));
  inputs::Random random(8);
  inputs::shuffle(order, random);
  for (const IdValue i : order) ASSERT_EQ((*mesh)->remove_feature(FeatureId{i}), Status::ok);
  EXPECT_TRUE(passes_audit(**mesh));
  graph.features.clear();
  EXPECT_EQ((*mesh)->hash(), (*built(graph))->hash());
}

// Both ends of a feature have many neighbours, and all that is between is on its line.
TEST(Hub, FacingAnotherIsJoinedToIt) {
  Graph graph = arc(inputs::full_turn_millidegrees, 3, 9);
  std::erase_if(graph.nodes, [](Position p) { return p.y == 0; });
  const std::size_t count = graph.nodes.size();
  graph.nodes.insert(graph.nodes.end(), {{-1000, 0}, {1000, 0}, {0, 0}, {10, 0}});
  const auto mesh = built(graph);
  FeatureId feature;
  ASSERT_EQ((*mesh)->add_feature(between_nodes(count, count + 1), feature), Status::ok);
  EXPECT_EQ((*mesh)->chain(feature, {}), 4u);
  EXPECT_TRUE(passes_audit(**mesh));
  ASSERT_EQ((*mesh)->leave(vertex_of(count + 2)), Status::ok);
  EXPECT_EQ((*mesh)->chain(feature, {}), 3u);
  EXPECT_TRUE(passes_audit(**mesh));
}

// The star shrinks with each of them.
TEST(Hub, AndItsNeighboursLeaveInAnyOrder) {
  Graph graph = arc(inputs::full_turn_millidegrees, 3, 5);
  graph.nodes.push_back({0, 0});
  graph.nodes.push_back({1, 1});
  const auto mesh = built(graph);
  std::vector<std::size_t> order(graph.nodes.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  inputs::Random random(6);
  inputs::shuffle(order, random);
  Graph rest = graph;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const Position gone = graph.nodes[order[k]];
    ASSERT_EQ((*mesh)->leave(vertex_of(order[k])), Status::ok);
    std::erase(rest.nodes, gone);
    if (k % 50 != 0 && rest.nodes.size() > 8) continue;
    ASSERT_TRUE(passes_audit(**mesh));
    ASSERT_EQ((*mesh)->hash(), (*built(rest))->hash()) << rest.nodes.size();
  }
}

}  // namespace
}  // namespace etcm::test
