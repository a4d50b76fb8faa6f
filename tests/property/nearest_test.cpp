// etcm/nearest.h against a sorted list of all nodes.
#include "etcm/nearest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "etcm/storage.h"
#include "inputs/corpus.h"
#include "inputs/patterns.h"
#include "inputs/random.h"
#include "support/emulated.h"
#include "support/history.h"
#include "support/meshes.h"

namespace etcm {

bool operator==(const NearNode& a, const NearNode& b) {
  return a.node == b.node && a.distance == b.distance;
}
void PrintTo(const NearNode& near, std::ostream* out) {
  *out << near.node.value << " at the root of " << near.distance.high << ":" << near.distance.low;
}

}  // namespace etcm

namespace etcm::test {
namespace {

std::vector<NearNode> all_by_distance(const Mesh& mesh, const Point& place) {
  std::vector<NearNode> nodes;
  for (IdValue id = 1; id < mesh.vertex_id_end(); ++id) {
    const VertexId v{id};
    if (mesh.kind(v) == VertexKind::node) {
      nodes.push_back({v, squared_distance(place, mesh.point(v))});
    }
  }
  std::sort(nodes.begin(), nodes.end(), [&](const NearNode& a, const NearNode& b) {
    return a.distance != b.distance ? a.distance < b.distance
                                    : mesh.point(a.node) < mesh.point(b.node);
  });
  return nodes;
}

std::vector<NearNode> nearest(const Mesh& mesh, const Point& place, std::size_t count) {
  std::vector<NearNode> nodes(count);
  nodes.resize(nearest_nodes(mesh, place, nodes));
  return nodes;
}

std::vector<NearNode> first_of(std::vector<NearNode> nodes, std::size_t count) {
  nodes.resize(std::min(nodes.size(), count));
  return nodes;
}

void expect_right_at(const Mesh& mesh, const Point& place, inputs::Random& random) {
  SCOPED_TRACE("at " + std::to_string(place.x) + "," + std::to_string(place.y));
  const std::vector<NearNode> all = all_by_distance(mesh, place);
  EXPECT_EQ(nearest_node(mesh, place), all.empty() ? VertexId::none() : all[0].node);
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{2}, std::size_t{7},
                                  random.index(all.size() + 1), all.size() + 3}) {
    EXPECT_EQ(nearest(mesh, place, count), first_of(all, count)) << count << " nodes";
  }
  std::vector<std::uint32_t> ranges{0, 1, UINT32_MAX};
  for (int i = 0; i < 3 && !all.empty(); ++i) {
    // The farthest of these is just within the one, and just beyond the other.
    const std::uint32_t range = range_for(all[random.index(all.size())].distance);
    ranges.insert(ranges.end(), {range, std::max(range, 1u) - 1});
  }
  for (const std::uint32_t range : ranges) {
    SCOPED_TRACE("range " + std::to_string(range));
    const std::vector<NearNode> within(
        all.begin(), std::find_if(all.begin(), all.end(), [range](const NearNode& near) {
          return range_for(near.distance) > range;
        }));
    EXPECT_EQ(nodes_within(mesh, place, range, {}), within.size());
    for (const std::size_t room : {random.index(within.size() + 1), within.size() + 2}) {
      std::vector<NearNode> nodes(room);
      EXPECT_EQ(nodes_within(mesh, place, range, nodes), within.size());
      EXPECT_EQ(first_of(nodes, within.size()), first_of(within, room)) << room << " fit";
    }
  }
}

// Vertices, places in the midst of two or of four, any place, and the corners of what there is.
Point any_place(const Mesh& mesh, inputs::Random& random) {
  constexpr std::int64_t most = std::int64_t{1} << 52;
  std::vector<Point> points{{0, 0}};
  for (IdValue id = 1; id < mesh.vertex_id_end(); ++id) {
    if (mesh.kind(VertexId{id}) != VertexKind::none) points.push_back(mesh.point(VertexId{id}));
  }
  const auto one = [&] { return points[random.index(points.size())]; };
  const Point a = one(), b = one(), c = one();
  switch (random.below(6)) {
    case 0:
      return a;
    case 1:
      return {(a.x + b.x) / 2, (a.y + b.y) / 2};
    case 2:
      return {a.x, b.y};
    case 3:
      return {(a.x + c.x) / 2, (b.y + c.y) / 2};
    case 4:
      return {random.below(2) == 0 ? -most : most, random.below(2) == 0 ? most : b.y};
    default:
      return {static_cast<std::int64_t>(random.below(2 * most)) - most,
              static_cast<std::int64_t>(random.below(2 * most)) - most};
  }
}

void expect_right(const Mesh& mesh, std::uint64_t seed, int places) {
  inputs::Random random(seed);
  for (int i = 0; i < places; ++i) expect_right_at(mesh, any_place(mesh, random), random);
}

TEST(NearestNodes, OfNoneAndFew) {
  const auto mesh = empty_mesh(20, 5);
  expect_right(**mesh, 1, 5);
  for (const Position position : {Position{3, 3}, {-3, 3}, {0, 0}, {7, -7}}) {
    VertexId id;
    ASSERT_EQ((*mesh)->join(position, id), Status::ok);
    expect_right(**mesh, id.value, 40);
  }
}

TEST(NearestNodes, OfNodesOnALine) {
  for (const Position step :
       {Position{1, 0}, {0, 1}, {3, -2}, {position_max / 20, position_max / 20}}) {
    Graph graph;
    for (std::int32_t i = -20; i <= 20; i += 1 + (i & 1)) {
      graph.nodes.push_back({i * step.x, i * step.y});
    }
    expect_right(**grown(graph), 7, 60);
  }
}

// All places of a grid have ties; those in the midst of cells have four at a time.
TEST(NearestNodes, TieByPlace) {
  const auto mesh = built(inputs::grid(9, 4, inputs::GridFeatures::knight_moves, 3));
  inputs::Random random(5);
  for (std::int64_t x = -2; x <= 34; x += 2) {
    for (std::int64_t y = -2; y <= 34; y += 2) {
      expect_right_at(**mesh, {x * subunits_per_unit, y * subunits_per_unit}, random);
    }
  }
}

TEST(NearestNodes, TieOnOneCircle) {
  const auto mesh = built(inputs::exact_circle(40, 2));
  inputs::Random random(5);
  expect_right_at(**mesh, {0, 0}, random);
  expect_right_at(**mesh, {1, -1}, random);
  EXPECT_EQ(nodes_within(**mesh, {0, 0}, 32045, {}), 324u);
  EXPECT_EQ(nodes_within(**mesh, {0, 0}, 32044, {}), 0u);
}

TEST(NearestNodes, PassOverSteinerVertices) {
  const auto mesh = built(inputs::parallels(20, 3, 1000, 60, 1));
  ASSERT_GT((*mesh)->steiner_count(), 100u);
  for (const VertexId steiner : steiner_vertices(**mesh)) {
    const Point place = (*mesh)->point(steiner);
    ASSERT_EQ(nearest(**mesh, place, 3), first_of(all_by_distance(**mesh, place), 3));
  }
}

// A vertex with many neighbours, most of which have it as their nearest.
TEST(NearestNodes, AroundAHub) {
  Graph graph = inputs::circle(is_slow ? 200 : 2000, 1'000'000, 0, 4);
  graph.nodes.push_back({1, 1});
  expect_right(**built(graph), 11, 10);
}

TEST(NearestNodes, AreFoundInAnyMesh) {
  constexpr std::size_t nodes_most = is_slow ? 100 : 600;
  for (const inputs::CorpusEntry& entry : inputs::corpus()) {
    if (entry.graph.nodes.size() > nodes_most || entry.family == "nearly collinear") continue;
    SCOPED_TRACE(entry.graph.name);
    OwnedMesh mesh(inputs::config_for(entry.graph, 12'000));
    ASSERT_EQ(mesh.opened(), Status::ok);
    // What is unresolved is a mesh too.
    static_cast<void>(mesh->build(entry.graph.nodes, entry.graph.features));
    expect_right(*mesh, 13, 6);
  }
}

TEST(NearestNodes, AreFoundWhileAMeshChanges) {
  const auto mesh = empty_mesh(400, 60);
  History history(**mesh, 60, 40, 17, Course::eventful);
  for (std::uint64_t step = 0; step < (is_slow ? 60 : 600); ++step) {
    ASSERT_TRUE(history.step());
    expect_right(**mesh, step, 1);
  }
}

TEST(NearestNodes, DependOnNoHistory) {
  const Graph graph = inputs::grid(12, 5, inputs::GridFeatures::cell_diagonals, 1);
  const auto one = built(graph);
  const auto other = grown(shuffled(graph, 9));
  inputs::Random random(3);
  for (int i = 0; i < 50; ++i) {
    const Point place = any_place(**one, random);
    const std::vector<NearNode> a = nearest(**one, place, 9), b = nearest(**other, place, 9);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t j = 0; j < a.size(); ++j) {
      EXPECT_EQ((*one)->point(a[j].node), (*other)->point(b[j].node));
    }
  }
}

}  // namespace
}  // namespace etcm::test
