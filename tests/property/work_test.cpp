// Whatever a call is allowed to do: it succeeds within that, or changes nothing within that.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "inputs/patterns.h"
#include "inputs/random.h"
#include "inputs/random_graph.h"
#include "support/emulated.h"
#include "support/meshes.h"
#include "support/oracle.h"

namespace etcm::test {
namespace {

// A mesh, and a call that is hard in it.
struct Task {
  const char* name;
  std::function<Graph()> graph;
  std::function<Status(Mesh& mesh, Work limit)> call;
};

void PrintTo(const Task& task, std::ostream* out) { *out << task.name; }

// What a power of two is added to, so that not all limits are alike.
constexpr std::size_t scale = is_slow ? 1 : 4;

// Node 1 in the midst of a circle: each of the others is a neighbour of it.
Graph hub() {
  constexpr std::size_t spokes = 100 * scale;
  Graph graph{"hub", {{0, 0}}, {}};
  for (std::size_t i = 0; i < spokes; ++i) {
    const double angle = 6.283185307179586 * static_cast<double>(i) / spokes;
    graph.nodes.push_back({static_cast<std::int32_t>(1e6 * std::cos(angle)),
                           static_cast<std::int32_t>(1e6 * std::sin(angle))});
  }
  return graph;
}

// Two rows that face each other, and no node between: a join there is a neighbour of all.
Graph rows() {
  constexpr std::size_t columns = 60 * scale;
  Graph graph{"rows", {}, {}};
  for (std::size_t i = 0; i < columns; ++i) {
    const auto x = static_cast<std::int32_t>(100 * i);
    graph.nodes.push_back({x, 0});
    graph.nodes.push_back({x + 50, 4'000'000});
  }
  return graph;
}

Graph many_parallels() { return inputs::parallels(15 * scale, 10, 100'000, 40, 3); }

// Node i stands at (100 i, 0), and others beside that line.
Graph one_through_many() {
  Graph graph{"one through many", {}, {}};
  constexpr std::size_t nodes = 60 * scale;
  inputs::Random random(5);
  for (std::size_t i = 0; i < nodes; ++i) {
    graph.nodes.push_back({static_cast<std::int32_t>(100 * i), 0});
  }
  for (std::size_t i = 0; i + 1 < nodes; ++i) {
    graph.nodes.push_back({static_cast<std::int32_t>(100 * i) + random.between(10, 90),
                           random.below(2) == 0 ? random.between(3, 30) : -random.between(3, 30)});
  }
  graph.features.push_back(between_nodes(0, nodes - 1));
  return graph;
}

Graph star_of_features() { return inputs::fan({40 * scale, 7200 / scale, 10'000, 90'000}); }

Graph random_features() { return inputs::random_graph(60 * scale, inputs::FeatureLength::any, 11); }

Graph all_but_one_random() {
  Graph graph = random_features();
  graph.features.pop_back();
  return graph;
}

Graph crossed_grid() { return inputs::grid(10, 10, inputs::GridFeatures::knight_moves, 7); }

Graph plain_grid() {
  Graph graph = inputs::grid(10, 10, inputs::GridFeatures::random_segments, 7);
  graph.features.clear();
  return graph;
}

Graph line_of_nodes() { return {"line", {{0, 0}, {4, 0}, {8, 0}, {12, 0}, {16, 0}}, {}}; }

Graph ring() { return inputs::exact_circle(20, 3); }

std::function<Status(Mesh&, Work)> join_at(std::int32_t x, std::int32_t y) {
  return [x, y](Mesh& mesh, Work limit) {
    VertexId id;
    return mesh.join({x, y}, id, limit);
  };
}

std::function<Status(Mesh&, Work)> leave_of(std::size_t node) {
  return [node](Mesh& mesh, Work limit) { return mesh.leave(vertex_of(node), limit); };
}

std::function<Status(Mesh&, Work)> move_to(std::size_t node, std::int32_t x, std::int32_t y) {
  return [node, x, y](Mesh& mesh, Work limit) { return mesh.move(vertex_of(node), {x, y}, limit); };
}

// Of those that no feature ends at.
VertexId first_free(Mesh& mesh) {
  VertexId v = vertex_of(0);
  while (mesh.leave(v, Work{0}) == Status::endpoint_in_use) ++v.value;
  return v;
}

Status leave_of_the_first(Mesh& mesh, Work limit) { return mesh.leave(first_free(mesh), limit); }

Status move_the_first(Mesh& mesh, Work limit) {
  const VertexId v = first_free(mesh);
  const Position place = mesh.position(v);
  return mesh.move(v, {place.x + 41, place.y - 23}, limit);
}

Status add_the_last(Mesh& mesh, Work limit) {
  FeatureId id;
  return mesh.add_feature(random_features().features.back(), id, limit);
}

Status remove_first(Mesh& mesh, Work limit) { return mesh.remove_feature(FeatureId{0}, limit); }

Status make_canonical(Mesh& mesh, Work limit) { return mesh.canonicalize(limit); }

Status lay_all(Mesh& mesh, Work limit) { return mesh.rebuild(limit); }

// One that has a few changes behind it, the same each time.
Status live(Mesh& mesh) {
  VertexId id;
  for (std::int32_t i = 1; i < 20; ++i) {
    static_cast<void>(mesh.join({37 * i, 53 * i % 1000}, id));
    if (i % 3 == 0) static_cast<void>(mesh.leave(id));
  }
  return Status::ok;
}

const std::vector<Task>& tasks() {
  static const std::vector<Task> all{
      {"hub_leaves", hub, leave_of(0)},
      {"hub_moves", hub, move_to(0, 12'345, 6789)},
      {"hub_moves_out", hub, move_to(0, 3'000'000, 6789)},
      {"joins_beside_the_hub", hub, join_at(3, 4)},
      {"joins_between_rows", rows, join_at(3000, 1'999'999)},
      {"joins_between_parallels", many_parallels, join_at(50'003, 305)},
      {"joins_above_parallels", many_parallels, join_at(50'003, 10'000)},
      {"joins_on_a_parallel", many_parallels, join_at(50'000, 300)},
      {"a_parallel_goes", many_parallels, remove_first},
      {"a_node_of_a_parallel_moves", many_parallels, move_to(20, -70, 102)},
      {"a_feature_through_many_goes", one_through_many, remove_first},
      {"a_node_of_many_leaves", one_through_many, leave_of(30)},
      {"a_node_of_many_moves", one_through_many, move_to(30, 3011, 13)},
      {"the_end_of_many_moves", one_through_many, move_to(0, -90, 7)},
      {"a_feature_across", all_but_one_random, add_the_last},
      {"joins_in_a_star", star_of_features, join_at(300, 7)},
      {"the_centre_of_a_star_moves", star_of_features, move_to(0, 11, 17)},
      {"a_feature_of_a_star_goes", star_of_features, remove_first},
      {"joins_at_random", random_features, join_at(501, 499)},
      {"leaves_at_random", random_features, leave_of_the_first},
      {"moves_at_random", random_features, move_the_first},
      {"joins_in_a_grid", crossed_grid, join_at(44, 43)},
      {"leaves_a_grid", plain_grid, leave_of(44)},
      {"leaves_a_ring", ring, leave_of(100)},
      {"joins_a_ring", ring, join_at(3, 5)},
      {"a_chord_of_a_ring_goes", ring, remove_first},
      {"an_end_of_a_chord_moves", ring,
       [](Mesh& mesh, Work limit) {
         return mesh.move(mesh.ends(FeatureId{0}).from, {32'046, 7}, limit);
       }},
      {"joins_beside_a_line", line_of_nodes, join_at(3, 5)},
      {"all_again", random_features, lay_all},
      {"all_of_parallels_again", many_parallels, lay_all},
      {"canonical_at_random", random_features, make_canonical},
      {"canonical_with_parallels", many_parallels, make_canonical},
      {"canonical_in_a_grid", crossed_grid, make_canonical},
  };
  return all;
}

class WorkOf : public testing::TestWithParam<Task> {
 protected:
  std::unique_ptr<OwnedMesh> prepared() const {
    auto mesh = built(GetParam().graph(), split_default, 20'000);
    const std::string name = GetParam().name;
    if (name.find("again") != std::string::npos || name.find("canonical") != std::string::npos) {
      EXPECT_EQ(live(**mesh), Status::ok);
    }
    return mesh;
  }
  Status call(Mesh& mesh, Work limit = Work::unlimited()) const {
    return GetParam().call(mesh, limit);
  }

 public:
  static std::string name(const testing::TestParamInfo<Task>& info) { return info.param.name; }
};

TEST_P(WorkOf, ACallStaysWithinTheLimit) {
  const auto mesh = prepared();
  const auto unlimited = prepared();
  const Status answer = call(**unlimited);
  const bool may_do_a_part = std::string(GetParam().name).starts_with("canonical");
  const Picture before = picture_of(**mesh);
  std::uint64_t units = 1;
  for (Status limited = Status::work_limit; limited == Status::work_limit; units += 1 + units / 3) {
    ASSERT_LT(units, std::uint64_t{1} << 40) << "no limit is enough";
    limited = call(**mesh, Work{units});
    ASSERT_LE((*mesh)->work_needed().units, units) << to_string(limited);
    ASSERT_LE((*mesh)->work_used(), (*mesh)->work_needed());
    if (limited != Status::work_limit) {
      EXPECT_EQ(limited, answer);
      break;
    }
    EXPECT_EQ((*mesh)->error_detail().status, limited);
    if (!may_do_a_part) {
      ASSERT_TRUE(picture_of(**mesh) == before) << units;
    }
    ASSERT_TRUE(passes_audit(**mesh)) << units;
  }
  EXPECT_EQ((*mesh)->hash(), (*unlimited)->hash());
  EXPECT_GT(units, 16u);
}

// One that sees all of a feature, from far: what it may touch is not looked at again unless it
// does.
TEST(WorkOfARefusedCall, IsWithinEachLimit) {
  Graph graph{"", {{0, 0}, {4000, 0}, {2000, 3000}}, {between_nodes(0, 1)}};
  for (std::int32_t i = 0; i < 40; ++i) graph.nodes.push_back({50 + 100 * i, -15});
  const auto mesh = built(graph);
  const VertexId far = vertex_of(2);
  ASSERT_GT((*mesh)->neighbours(far, {}), 8u);
  const Picture before = picture_of(**mesh);
  Status refused = Status::work_limit;
  for (std::uint64_t units = 1; refused == Status::work_limit; ++units) {
    ASSERT_LT(units, 100'000u) << "no limit is enough";
    refused = (*mesh)->move(far, {2000, 3001}, Work{units});
    ASSERT_LE((*mesh)->work_needed().units, units);
    if (refused == Status::work_limit) {
      ASSERT_TRUE(picture_of(**mesh) == before) << units;
    }
  }
  EXPECT_EQ(refused, Status::ok);
}

TEST_P(WorkOf, ACallNeedsWhatItSays) {
  const auto unlimited = prepared();
  const Status answer = call(**unlimited);
  const Work needed = (*unlimited)->work_needed();
  const auto enough = prepared();
  EXPECT_EQ(call(**enough, needed), answer);
  EXPECT_LE((*enough)->work_used(), needed);
  EXPECT_EQ((*enough)->hash(), (*unlimited)->hash());
  EXPECT_EQ((*enough)->work_needed(), needed);
  const auto too_little = prepared();
  EXPECT_EQ(call(**too_little, Work{needed.units - 1}), Status::work_limit);
}

INSTANTIATE_TEST_SUITE_P(Tasks, WorkOf, testing::ValuesIn(tasks()), WorkOf::name);

TEST(WorkOfABuild, IsEnoughOrLeavesNothing) {
  for (const auto& graph : {random_features(), many_parallels(), crossed_grid(), hub(),
                            one_through_many(), star_of_features()}) {
    const auto unlimited = built(graph, split_default, 20'000);
    const Work needed = (*unlimited)->work_needed();
    OwnedMesh mesh(inputs::config_for(graph, 20'000));
    for (std::uint64_t units = 1; units < needed.units; units *= 2) {
      ASSERT_EQ(mesh->build(graph.nodes, graph.features, Work{units}), Status::work_limit);
      EXPECT_LE(mesh->work_needed().units, units) << graph.name;
      EXPECT_EQ(mesh->node_count(), 0u);
      EXPECT_EQ(mesh->unresolved(), 0u);
    }
    ASSERT_EQ(mesh->build(graph.nodes, graph.features, needed), Status::ok) << graph.name;
    EXPECT_EQ(mesh->hash(), (*unlimited)->hash());
    EXPECT_EQ(mesh->work_needed(), needed);
  }
}

TEST(WorkOfARestore, IsEnoughOrLeavesNothing) {
  const Graph graph = random_features();
  const auto standing = built(graph);
  std::vector<SteinerPlace> steiner;
  for (const VertexId v : steiner_vertices(**standing)) {
    steiner.push_back({(*standing)->feature_of(v).value, (*standing)->point(v)});
  }
  OwnedMesh mesh(inputs::config_for(graph, 1500));
  ASSERT_EQ(mesh->restore(graph.nodes, graph.features, steiner), Status::ok);
  const Work needed = mesh->work_needed();
  mesh->clear();
  for (std::uint64_t units = 1; units < needed.units; units *= 2) {
    ASSERT_EQ(mesh->restore(graph.nodes, graph.features, steiner, Work{units}), Status::work_limit);
    EXPECT_LE(mesh->work_needed().units, units);
    EXPECT_EQ(mesh->node_count(), 0u);
  }
  ASSERT_EQ(mesh->restore(graph.nodes, graph.features, steiner, needed), Status::ok);
  EXPECT_EQ(mesh->hash(), (*standing)->hash());
}

// Two rows that face each other: from one end of them to the other it is a long way.
Graph long_way() {
  Graph graph{"long way", {}, {}};
  for (std::int32_t i = 0; i < 300; ++i) {
    graph.nodes.push_back({10 * i, 50 + i * i % 3});
    graph.nodes.push_back({10 * i + 5, -50 - i * i % 3});
  }
  return graph;
}

// Refused after it has come to the other end of that way, and back again, whatever it is beside.
void expect_moves_within_each_limit(const Graph& graph, VertexId node) {
  const Position away{2993, 3};
  const auto mesh = built(graph), unlimited = built(graph);
  const Picture before = picture_of(**mesh);
  ASSERT_EQ((*unlimited)->move(node, away), Status::ok);
  const std::uint64_t needed = (*unlimited)->work_needed().units;
  for (std::uint64_t units = 1; units < needed; units += 1 + units / 128) {
    ASSERT_EQ((*mesh)->move(node, away, Work{units}), Status::work_limit);
    ASSERT_LE((*mesh)->work_needed().units, units);
    ASSERT_TRUE(picture_of(**mesh) == before) << units;
  }
}

TEST(WorkOfARefusedMove, IsWithinEachLimitWhereAllBesideItHaveManyNeighbours) {
  Graph graph = long_way();
  const std::size_t v = graph.nodes.size();
  graph.nodes.insert(graph.nodes.end(),
                     {{-9000, 0}, {-3000, 3}, {-3000, 20'000}, {-3000, -20'000}});
  for (std::int32_t i = -20; i <= 20; ++i) graph.nodes.push_back({-50 + i * i % 3, 20 * i});
  for (std::int32_t i = 0; i < 24; ++i) {
    graph.nodes.push_back({100 * i, 1000 - i * i / 4});
    graph.nodes.push_back({100 * i, -1000 + i * i / 4});
  }
  graph.features.push_back(between_nodes(v, v + 1));
  const auto mesh = built(graph);
  std::vector<Neighbour> beside((*mesh)->neighbours(vertex_of(v), {}));
  ASSERT_EQ((*mesh)->neighbours(vertex_of(v), beside), beside.size());
  for (const Neighbour& one : beside) ASSERT_GT((*mesh)->neighbours(one.vertex, {}), 16u);
  expect_moves_within_each_limit(graph, vertex_of(v));
}

TEST(WorkOfARefusedMove, IsWithinEachLimitWhereOnlySteinerVerticesAreBesideIt) {
  Graph graph = long_way();
  const std::size_t v = graph.nodes.size();
  graph.nodes.insert(graph.nodes.end(),
                     {{-5000, 0}, {-9000, 2}, {-900, 2}, {-9000, -2}, {-900, -2}});
  for (const std::int32_t x : {-5040, -4960}) {
    graph.nodes.insert(graph.nodes.end(), {{x, 4}, {x, -4}});
  }
  graph.features = {between_nodes(v + 1, v + 2), between_nodes(v + 3, v + 4)};
  const auto mesh = built(graph);
  std::vector<Neighbour> beside((*mesh)->neighbours(vertex_of(v), {}));
  ASSERT_EQ((*mesh)->neighbours(vertex_of(v), beside), beside.size());
  for (const Neighbour& one : beside) ASSERT_EQ((*mesh)->kind(one.vertex), VertexKind::steiner);
  expect_moves_within_each_limit(graph, vertex_of(v));
}

// What is looked at while a trial is taken back is in the room that was kept for it.
TEST(WorkOfTrials, ThatAreTakenBackIsWhatTheyNeed) {
  const Graph graph{
      "five",
      {{25, 5}, {16, 3}, {15, 7}, {9, 15}, {15, 22}},
      {between_nodes(0, 4), between_nodes(3, 2), between_nodes(2, 4), between_nodes(1, 4)}};
  for (std::uint32_t trials = 1; trials < 40; ++trials) {
    const Work needed = [&] {
      const auto unlimited = built(graph);
      EXPECT_EQ((*unlimited)->optimise(trials), Status::ok);
      return (*unlimited)->work_needed();
    }();
    EXPECT_EQ((*built(graph))->optimise(trials, 0, needed), Status::ok) << trials;
    EXPECT_EQ((*built(graph))->optimise(trials, 0, Work{needed.units - 1}), Status::work_limit)
        << trials;
  }
}

TEST(Work, OfNothingIsEnoughForNothing) {
  const auto mesh = built(random_features());
  const Picture before = picture_of(**mesh);
  VertexId id;
  FeatureId feature;
  EXPECT_EQ((*mesh)->join({1, 1}, id, Work{0}), Status::work_limit);
  EXPECT_EQ((*mesh)->move(vertex_of(3), {1, 1}, Work{0}), Status::work_limit);
  EXPECT_EQ((*mesh)->add_feature(between_nodes(3, 7), feature, Work{0}), Status::work_limit);
  EXPECT_EQ((*mesh)->remove_feature(FeatureId{0}, Work{0}), Status::work_limit);
  EXPECT_EQ((*mesh)->work_needed(), Work{0});
  EXPECT_TRUE(picture_of(**mesh) == before);
  // What is wrong in itself is said first.
  EXPECT_EQ((*mesh)->leave(VertexId{60'000}, Work{0}), Status::unknown_vertex);
  EXPECT_EQ((*mesh)->join({position_max + 1, 0}, id, Work{0}), Status::bad_coordinate);
}

}  // namespace
}  // namespace etcm::test
