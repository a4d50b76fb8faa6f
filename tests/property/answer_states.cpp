#include "answer_states.h"

#include <algorithm>
#include <cstddef>
#include <iterator>

#include "etcm/storage.h"
#include "inputs/owned_mesh.h"
#include "support/split_in_the_middle.h"

namespace etcm::test {
namespace {

constexpr MeshConfig roomy{.vertices_max = 40, .features_max = 20};
// Wide enough for the state itself, then one more, and so on.
constexpr std::uint32_t tight_steps = 4;

void build_lines(Mesh& mesh) {
  ASSERT_EQ(mesh.build(crossing_lines().nodes, crossing_lines().features), Status::ok);
}

void build_nodes(Mesh& mesh) { ASSERT_EQ(mesh.build(crossing_lines().nodes, {}), Status::ok); }

void build_row(Mesh& mesh) {
  const FeatureEnds feature[] = {between_nodes(0, 3)};
  const Position nodes[] = {{0, 0}, {4, 0}, {8, 0}, {12, 0}};
  ASSERT_EQ(mesh.build(nodes, feature), Status::ok);
}

void join_one(Mesh& mesh) {
  VertexId id;
  ASSERT_EQ(mesh.join({8, 0}, id), Status::ok);
}

// One by one, with a node that has left in between, so that ids have holes and nothing is
// canonical.
void grow_lines(Mesh& mesh) {
  const Graph& lines = crossing_lines();
  std::vector<VertexId> ids;
  for (const Position node : lines.nodes) {
    ids.emplace_back();
    ASSERT_EQ(mesh.join(node, ids.back()), Status::ok);
    if (ids.size() != 3) continue;
    VertexId stray;
    ASSERT_EQ(mesh.join({3, 5}, stray), Status::ok);
  }
  for (const FeatureEnds& ends : lines.features) {
    FeatureId id;
    ASSERT_EQ(mesh.add_feature({ids[ends.from.value - 1u], ids[ends.to.value - 1u]}, id),
              Status::ok);
  }
  ASSERT_EQ(mesh.leave(VertexId{4}), Status::ok);
}

void load_from(Mesh& mesh, std::size_t harmed) {
  OwnedMesh other(roomy);
  build_lines(*other);
  std::vector<std::byte> bytes(other->saved_bytes());
  ASSERT_EQ(other->save(bytes), Status::ok);
  if (harmed < bytes.size()) bytes[harmed] ^= std::byte{1};
  ASSERT_EQ(mesh.load(bytes) == Status::ok, harmed >= bytes.size());
}

void restore_lines(Mesh& mesh) {
  OwnedMesh other(roomy);
  build_lines(*other);
  std::vector<SteinerPlace> places;
  for (const VertexId v : steiner_vertices(*other)) {
    places.push_back({other->feature_of(v).value, other->point(v)});
  }
  ASSERT_EQ(mesh.restore(crossing_lines().nodes, crossing_lines().features, places), Status::ok);
}

// With fewer Steiner vertices than build() would make, and no room for more.
void load_optimised(Mesh& mesh) {
  OwnedMesh other(roomy);
  const Position nodes[] = {{25, 5}, {16, 3}, {15, 7}, {9, 15}, {15, 22}};
  const FeatureEnds features[] = {between_nodes(0, 4), between_nodes(3, 2), between_nodes(2, 4),
                                  between_nodes(1, 4)};
  ASSERT_EQ(other->build(nodes, features), Status::ok);
  ASSERT_EQ(other->optimise(30), Status::ok);
  ASSERT_EQ(other->steiner_count(), 1u);
  std::vector<std::byte> bytes(other->saved_bytes());
  ASSERT_EQ(other->save(bytes), Status::ok);
  ASSERT_EQ(mesh.load(bytes), Status::ok);
}

// The configuration of the last capacity that holds the state, and of some more.
std::vector<WayToState> tight(std::uint32_t MeshConfig::*capacity, std::uint32_t least,
                              const std::function<void(Mesh&)>& make) {
  std::vector<WayToState> ways;
  for (std::uint32_t more = 0; more < tight_steps; ++more) {
    MeshConfig config = roomy;
    config.*capacity = least + more;
    ways.push_back({config, make});
  }
  return ways;
}

void append(std::vector<WayToState>& ways, std::vector<WayToState> more) {
  std::move(more.begin(), more.end(), std::back_inserter(ways));
}

std::vector<WayToState> empty_ways() {
  std::vector<WayToState> ways{{roomy, [](Mesh&) {}}};
  for (std::uint32_t room = 1; room < 12; ++room) {
    ways.push_back({{.vertices_max = room, .features_max = 20}, [](Mesh&) {}});
    ways.push_back({{.vertices_max = 40, .features_max = room - 1}, [](Mesh&) {}});
  }
  ways.push_back({{.vertices_max = 40, .features_max = 20, .steiner_max = 1}, [](Mesh&) {}});
  return ways;
}

std::vector<WayToState> refused_builds() {
  std::vector<WayToState> ways;
  for (const Graph& graph : wrong_graphs()) {
    ways.push_back({roomy, [&graph](Mesh& mesh) {
                      ASSERT_NE(mesh.build(graph.nodes, graph.features), Status::ok);
                    }});
  }
  ways.push_back({roomy, [](Mesh& mesh) {
                    const Graph& lines = crossing_lines();
                    ASSERT_EQ(mesh.build(lines.nodes, lines.features, Work{200}),
                              Status::work_limit);
                  }});
  return ways;
}

std::vector<WayToState> unresolved_ways() {
  const auto fail = [](Mesh& mesh) {
    ASSERT_NE(mesh.build(crossing_lines().nodes, crossing_lines().features), Status::ok);
    ASSERT_NE(mesh.unresolved(), 0u);
  };
  const auto nodes = static_cast<std::uint32_t>(crossing_lines().nodes.size());
  return {
      {{.vertices_max = 40, .features_max = 20, .steiner_max = 1}, fail},
      {{.vertices_max = nodes, .features_max = 20}, fail},
      {{.vertices_max = nodes + 1, .features_max = 20}, fail},
      {{.vertices_max = 300, .features_max = 20, .policy = split_in_the_middle}, [](Mesh& mesh) {
         ASSERT_EQ(mesh.build(needle_eye().nodes, needle_eye().features), Status::grid_exhausted);
       }}};
}

std::vector<WayToState> limited_ways() {
  const auto refuse = [](Mesh& mesh) {
    grow_lines(mesh);
    VertexId v;
    FeatureId f;
    ASSERT_EQ(mesh.join({6, 1}, v, Work{30}), Status::work_limit);
    ASSERT_EQ(mesh.move(VertexId{2}, {6, 1}, Work{60}), Status::work_limit);
    ASSERT_EQ(mesh.add_feature({VertexId{7}, VertexId{3}}, f, Work{40}), Status::work_limit);
    ASSERT_EQ(mesh.remove_feature(FeatureId{0}, Work{20}), Status::work_limit);
  };
  return {{roomy, refuse},
          {roomy,
           [](Mesh& mesh) {
             grow_lines(mesh);
             ASSERT_EQ(mesh.rebuild(Work{100}), Status::work_limit);
           }},
          {roomy, [](Mesh& mesh) {
             grow_lines(mesh);
             ASSERT_EQ(mesh.canonicalize(Work{100}), Status::work_limit);
             ASSERT_EQ(mesh.optimise(5, 0, Work{200}), Status::work_limit);
           }}};
}

std::vector<WayToState> refused_loads() {
  std::vector<WayToState> ways;
  for (const std::size_t harmed : {0u, 9u, 20u, 60u, 100u}) {
    ways.push_back({roomy, [harmed](Mesh& mesh) { load_from(mesh, harmed); }});
  }
  return ways;
}

std::vector<WayToState> own_policy_ways() {
  const MeshConfig config{.vertices_max = 300, .features_max = 20, .policy = split_in_the_middle};
  return {{config, [](Mesh&) {}},
          {config, build_lines},
          {config, [](Mesh& mesh) { ASSERT_EQ(mesh.build(needle_eye().nodes, {}), Status::ok); }},
          {config, [](Mesh& mesh) {
             std::vector<Position> nodes = needle_eye().nodes;
             nodes.back() = {0, 50};
             ASSERT_EQ(mesh.build(nodes, needle_eye().features), Status::ok);
           }}};
}

}  // namespace

const Graph& crossing_lines() {
  static const Graph graph{"lines",
                           {{0, 0},
                            {8, 0},
                            {4, 1},
                            {4, -1},
                            {16, 0},
                            {12, 0},
                            {8, -6},
                            {8, 6},
                            {14, 0},
                            {14, 1},
                            {14, -1},
                            {12, 4},
                            {9, 3},
                            {7, 3}},
                           {between_nodes(0, 4), between_nodes(6, 7), between_nodes(5, 11)}};
  return graph;
}

const std::vector<Graph>& wrong_graphs() {
  static const std::vector<Graph> graphs{
      {"bad coordinate", {{0, 0}, {position_max + 1, 0}}, {}},
      {"duplicate", {{0, 0}, {1, 0}, {0, 0}}, {}},
      {"unknown vertex", {{0, 0}, {1, 0}}, {between_nodes(0, 2)}},
      {"vertex at infinity", {{0, 0}, {1, 0}}, {{VertexId{1}, infinite_vertex}}},
      {"zero length", {{0, 0}, {1, 0}}, {between_nodes(1, 1)}},
      {"repeated", {{0, 0}, {1, 0}}, {between_nodes(0, 1), between_nodes(1, 0)}},
      {"overlapping", {{0, 0}, {2, 0}, {1, 0}}, {between_nodes(0, 1), between_nodes(2, 1)}},
      {"crossing", {{0, 0}, {2, 2}, {0, 2}, {2, 0}}, {between_nodes(0, 1), between_nodes(2, 3)}}};
  return graphs;
}

const Graph& needle_eye() {
  static const Graph graph{"needle eye",
                           {{-position_max, 0},
                            {position_max - 101, 1},
                            {-position_max + 1, 1},
                            {-position_max + 2, 1},
                            beside_the_line},
                           {between_nodes(0, 1)}};
  return graph;
}

std::vector<MeshSituation> mesh_situations() {
  const auto nodes = static_cast<std::uint32_t>(crossing_lines().nodes.size());
  OwnedMesh lines(roomy);
  build_lines(*lines);
  const std::uint32_t vertices = nodes + lines->steiner_count();
  std::vector<WayToState> full = tight(&MeshConfig::vertices_max, vertices, build_lines);
  append(full, tight(&MeshConfig::vertices_max, vertices + 1, grow_lines));
  append(full, tight(&MeshConfig::vertices_max, 1, join_one));
  std::vector<WayToState> few_segments = tight(&MeshConfig::features_max, 7, build_lines);
  append(few_segments, tight(&MeshConfig::features_max, 7, grow_lines));
  append(few_segments, tight(&MeshConfig::features_max, 3, build_row));
  append(few_segments, tight(&MeshConfig::features_max, 0, build_nodes));
  std::vector<WayToState> few_steiner =
      tight(&MeshConfig::steiner_max, lines->steiner_count(), build_lines);
  append(few_steiner, tight(&MeshConfig::steiner_max, lines->steiner_count(), grow_lines));
  append(few_steiner, tight(&MeshConfig::steiner_max, 1, load_optimised));
  return {
      {"opened and empty", empty_ways()},
      {"cleared",
       {{roomy,
         [](Mesh& mesh) {
           build_lines(mesh);
           mesh.clear();
         }}}},
      {"one node", {{roomy, join_one}}},
      {"nodes on a line and a feature through them", {{roomy, build_row}}},
      {"nodes alone", {{roomy, build_nodes}}},
      {"built, with features", {{roomy, build_lines}}},
      {"grown, not canonical", {{roomy, grow_lines}}},
      {"after a refused build()", refused_builds()},
      {"build() left a part undone", unresolved_ways()},
      {"after calls that needed more work than their limit", limited_ways()},
      {"after a refused load()", refused_loads()},
      {"after load() or restore()",
       {{roomy, [](Mesh& mesh) { load_from(mesh, ~std::size_t{0}); }}, {roomy, restore_lines}}},
      {"after rebuild() or canonicalize()",
       {{roomy,
         [](Mesh& mesh) {
           grow_lines(mesh);
           ASSERT_EQ(mesh.rebuild(), Status::ok);
         }},
        {roomy,
         [](Mesh& mesh) {
           grow_lines(mesh);
           ASSERT_EQ(mesh.canonicalize(), Status::ok);
         }}}},
      {"after optimise()",
       {{roomy,
         [](Mesh& mesh) {
           build_lines(mesh);
           ASSERT_EQ(mesh.optimise(8), Status::ok);
         }}}},
      {"full of vertices, or nearly", full},
      {"full of segments, or nearly", few_segments},
      {"as many Steiner vertices as it may have, or nearly", few_steiner},
      {"a policy that need not end", own_policy_ways()},
  };
}

}  // namespace etcm::test
