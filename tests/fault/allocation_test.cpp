// No call of the library allocates: not in a good run, and not in a refused one.
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <memory>
#include <vector>

#include "etcm/analysis.h"
#include "etcm/audit.h"
#include "etcm/domain.h"
#include "etcm/incidence.h"
#include "etcm/locate.h"
#include "etcm/nearest.h"
#include "etcm/storage.h"
#include "etcm/traverse.h"
#include "inputs/random_graph.h"
#include "support/allocation_watch.h"
#include "support/meshes.h"

namespace etcm::test {
namespace {

// The trap must be seen to work before its silence means anything.
TEST(AllocationWatch, CountsEveryWayToAllocate) {
  AllocationWatch watch;
  const std::unique_ptr<int> single = std::make_unique<int>(1);
  EXPECT_EQ(watch.allocations(), 1u);
  const std::vector<int> many(10);
  EXPECT_EQ(watch.allocations(), 2u);
  // Volatile, or the compiler may leave out a pair of malloc and free.
  void* volatile raw = std::malloc(16);
  EXPECT_EQ(watch.allocations(), 3u);
  std::free(raw);
}

TEST(Allocation, IsAbsentFromEveryCall) {
  const Graph graph = inputs::random_graph(400, inputs::FeatureLength::any, 5);
  static MeshStorage<4000, 600> storage;
  std::array<Neighbour, 64> neighbours;
  std::array<VertexId, 256> chain;
  std::array<NearNode, 20> near;
  static std::array<Region, 8000> regions;
  static std::array<TriangleId, 8000> scratch;
  std::array<Status, 12> answers{};
  std::uint64_t read = 0;
  bool sound = false;
  std::size_t allocations = 1;
  {
    AllocationWatch watch;
    Mesh mesh;
    answers[0] = mesh.open(storage.bytes(), storage.config());
    answers[1] = mesh.build(graph.nodes, graph.features);
    VertexId joined;
    answers[2] = mesh.join({500, -20}, joined);
    answers[3] = mesh.move(joined, {1400, 1400});
    FeatureId feature;
    answers[4] = mesh.add_feature({joined, VertexId{1}}, feature);
    answers[5] = mesh.leave(joined);
    answers[6] = mesh.remove_feature(FeatureId{0});
    answers[7] = mesh.rebuild();
    answers[8] = label_domain(mesh, Exterior::automatic, {}, regions, scratch);
    answers[9] = mesh.join({position_max + 1, 0}, joined);
    sound = bool(audit(mesh));
    read += mesh.hash() + mesh.neighbours(VertexId{1}, neighbours);
    read += mesh.chain(FeatureId{1}, chain);
    read += static_cast<std::uint64_t>(locate(mesh, mesh.point(VertexId{2})).type);
    read += nearest_nodes(mesh, {1, 1}, near) + nodes_within(mesh, {1, 1}, 600, near);
    read += features_at(mesh, VertexId{1}, {}) + feature_between(mesh, chain[0], chain[1]).value;
    for (const MeshEdge& edge : edges_of(mesh)) read += edge.to.value;
    mesh.clear();
    allocations = watch.allocations();
  }
  EXPECT_EQ(allocations, 0u);
  EXPECT_TRUE(sound);
  EXPECT_NE(read, 0u);
  for (const std::size_t good : {0u, 1u, 2u, 3u, 6u, 7u, 8u})
    EXPECT_EQ(answers[good], Status::ok) << good;
  EXPECT_EQ(answers[9], Status::bad_coordinate);
}

TEST(Allocation, IsAbsentFromTheAnalysis) {
  const Graph graph = inputs::random_graph(400, inputs::FeatureLength::any, 5);
  static MeshStorage<4000, 600> storage;
  static std::array<Region, 8000> regions;
  static std::array<TriangleId, 8000> waiting;
  static std::array<ConnectivityScratch, 4001> scratch;
  static std::array<std::int32_t, 4001> readings;
  std::array<Link, 8> link;
  std::array<Relay, 8> relay;
  std::array<Gap, 8> gap;
  std::array<Hole, 8> hole;
  Connectivity connected;
  Interpolated reading;
  Mesh mesh;
  ASSERT_EQ(mesh.open(storage.bytes(), storage.config()), Status::ok);
  ASSERT_EQ(mesh.build(graph.nodes, graph.features), Status::ok);
  static MeshStorage<400, 0> nodes_storage;
  Mesh nodes;
  ASSERT_EQ(nodes.open(nodes_storage.bytes(), nodes_storage.config()), Status::ok);
  ASSERT_EQ(nodes.build(graph.nodes, {}), Status::ok);
  ASSERT_EQ(label_domain(mesh, Exterior::automatic, {}, regions, waiting), Status::ok);
  std::array<std::uint64_t, 5> counts{};
  std::array<Status, 2> answers{};
  std::size_t allocations = 1;
  {
    AllocationWatch watch;
    counts = {links(mesh, 0, link), links_at(mesh, VertexId{1}, link),
              relays(mesh, nodes, 10, relay), barrier_gaps(mesh, nodes, 3, gap),
              coverage_holes(nodes, {.mesh = &mesh, .region = regions}, 3, hole)};
    answers = {connectivity(mesh, 10, scratch, connected),
               interpolate(mesh, to_point({500, 500}), readings, reading)};
    allocations = watch.allocations();
  }
  EXPECT_EQ(allocations, 0u);
  for (const std::uint64_t count : counts) EXPECT_GT(count, 2u);
  for (const Status answer : answers) EXPECT_EQ(answer, Status::ok);
}

}  // namespace
}  // namespace etcm::test
