// The function that long calls call: often enough, and it cannot change the mesh.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "etcm/analysis.h"
#include "etcm/audit.h"
#include "etcm/domain.h"
#include "etcm/dry_run.h"
#include "etcm/nearest.h"
#include "etcm/storage.h"
#include "inputs/patterns.h"
#include "inputs/random_graph.h"
#include "support/meshes.h"
#include "triangulation/locate.h"
#include "triangulation/march.h"
#include "triangulation/mesh_state.h"

namespace etcm::test {
namespace {

// What is between two calls of the hook, in units that are counted.
struct Watch {
  const Mesh* mesh = nullptr;
  std::uint64_t calls = 0;
  std::uint64_t last = 0;
  std::uint64_t longest = 0;

  void look() noexcept {
    const std::uint64_t now = internal::MeshAccess::state(*mesh)->work.used().units;
    if (now > last) longest = std::max(longest, now - last);
    last = now;
  }
};

KeepAlive hook_of(Watch& watch) {
  return {[](void* context) noexcept {
            Watch& of = *static_cast<Watch*>(context);
            ++of.calls;
            of.look();
          },
          &watch};
}

std::vector<SteinerPlace> places_of(const Mesh& mesh) {
  std::vector<SteinerPlace> places;
  for (const VertexId v : steiner_vertices(mesh)) {
    places.push_back({mesh.feature_of(v).value, mesh.point(v)});
  }
  return places;
}

// Each call that may take long, on meshes that are hard in different ways.
class LongCalls : public testing::TestWithParam<Graph> {
 protected:
  LongCalls() : mesh_(inputs::config_for(graph(), 20'000)) {}

  const Graph& graph() const { return GetParam(); }
  Status build(Mesh& mesh) const { return mesh.build(graph().nodes, graph().features); }

  // The call is answered as without the hook, and the hook is called as often as it promises.
  void watch(Mesh& mesh, const std::function<Status()>& call) {
    Watch seen{.mesh = &mesh};
    mesh.keep_alive(hook_of(seen));
    ASSERT_EQ(call(), Status::ok);
    seen.look();
    mesh.keep_alive({});
    // A list of nodes or features is counted before it is gone through.
    const std::uint64_t walk = 2 * mesh.triangle_count();
    const std::uint64_t lists = 24 * std::max(graph().nodes.size(), graph().features.size());
    const std::uint64_t promised = KeepAlive::units_between + std::max(walk, lists);
    EXPECT_LE(seen.longest, promised);
    EXPECT_GE(seen.calls, mesh.work_used().units / promised);
    longest_ = std::max(longest_, seen.longest);
  }

  inputs::OwnedMesh mesh_;
  std::uint64_t longest_ = 0;
};

TEST_P(LongCalls, AreInterruptedOftenAndComeToTheSame) {
  const auto plain = built(graph(), split_default, 20'000);
  watch(*mesh_, [&] { return build(*mesh_); });
  EXPECT_EQ(mesh_->hash(), (*plain)->hash());
  EXPECT_EQ(mesh_->work_needed(), (*plain)->work_needed());

  const VertexId first = VertexId{1};
  const Position away{mesh_->position(first).x + 3, mesh_->position(first).y - 7};
  watch(*mesh_, [&] { return mesh_->move(first, away); });
  ASSERT_EQ((*plain)->move(first, away), Status::ok);
  EXPECT_EQ(mesh_->hash(), (*plain)->hash());

  const std::vector<SteinerPlace> places = places_of(*mesh_);
  std::vector<Position> nodes;
  for (IdValue i = 1; i <= graph().nodes.size(); ++i) nodes.push_back(mesh_->position(VertexId{i}));
  inputs::OwnedMesh restored(inputs::config_for(graph(), 20'000));
  watch(*restored, [&] { return restored->restore(nodes, graph().features, places); });
  EXPECT_EQ(restored->hash(), (*plain)->hash());

  watch(*restored, [&] { return restored->rebuild(); });
  watch(*mesh_, [&] { return mesh_->canonicalize(); });
  EXPECT_EQ(mesh_->hash(), restored->hash());
  watch(*mesh_, [&] { return mesh_->optimise(10); });
  watch(*mesh_, [&] { return mesh_->remove_feature(FeatureId{0}); });
  RecordProperty("longest", static_cast<int>(longest_));
}

std::string graph_of(const testing::TestParamInfo<Graph>& one) {
  return std::vector<std::string>{"random", "parallels", "fan", "grid"}.at(one.index);
}

INSTANTIATE_TEST_SUITE_P(Of, LongCalls,
                         testing::Values(inputs::random_graph(300, inputs::FeatureLength::any, 3),
                                         inputs::parallels(40, 10, 100'000, 40, 3),
                                         inputs::fan({100, 7200 / 4, 10'000, 90'000}),
                                         inputs::grid(16, 16, inputs::GridFeatures::random_segments,
                                                      7)),
                         graph_of);

// All nodes on one circle: marking a chord turns ties.
TEST(KeepAliveOfTies, IsCalledWhileTheyTurn) {
  const Graph ring = inputs::exact_circle(20, 3);
  inputs::OwnedMesh mesh(inputs::config_for(ring, 2000));
  ASSERT_EQ(mesh->build(ring.nodes, {}), Status::ok);
  Watch seen{.mesh = &*mesh};
  mesh->keep_alive(hook_of(seen));
  FeatureId id;
  ASSERT_EQ(mesh->add_feature(between_nodes(0, ring.nodes.size() / 2), id), Status::ok);
  EXPECT_GE(seen.calls, mesh->work_used().units / KeepAlive::units_between);
}

// Calls of the hook that a read of a large mesh makes; of a copy for a reader, which has none.
struct Reads {
  std::vector<std::uint64_t> storage;
  Mesh mesh;
  std::vector<std::byte> saved;
  std::vector<Region> region;
  std::vector<TriangleId> waiting;
  std::vector<ConnectivityScratch> parts;

  explicit Reads(const Graph& graph) {
    const MeshConfig config = inputs::config_for(graph, 8000);
    storage.resize(storage_bytes(config) / sizeof storage[0] + 1);
    EXPECT_EQ(mesh.open(bytes(), config), Status::ok);
    EXPECT_EQ(mesh.build(graph.nodes, graph.features), Status::ok);
    saved.resize(mesh.saved_bytes());
    region.resize(mesh.triangle_count());
    waiting.resize(mesh.triangle_count());
    parts.resize(mesh.vertex_id_end());
  }

  std::span<std::byte> bytes() { return std::as_writable_bytes(std::span(storage)); }

  std::vector<std::pair<const char*, std::function<std::uint64_t(const Mesh&)>>> all() {
    return {
        {"hash", [](const Mesh& m) { return m.hash(); }},
        {"save",
         [this](const Mesh& m) {
           EXPECT_EQ(m.save(saved), Status::ok);
           return std::uint64_t(saved[saved.size() - 1]);
         }},
        {"audit", [](const Mesh& m) { return std::uint64_t(audit(m).broken); }},
        {"label_domain",
         [this](const Mesh& m) {
           EXPECT_EQ(label_domain(m, Exterior::automatic, {}, region, waiting), Status::ok);
           return std::uint64_t(std::count(region.begin(), region.end(), Region::inside));
         }},
        {"nodes_within",
         [](const Mesh& m) {
           return nodes_within(m, {0, 0}, 100'000, {});
         }},
        {"links", [](const Mesh& m) { return links(m, 0, {}); }},
        {"connectivity",
         [this](const Mesh& m) {
           Connectivity answer;
           EXPECT_EQ(connectivity(m, 5, parts, answer), Status::ok);
           return std::uint64_t{answer.parts};
         }},
        {"relays", [](const Mesh& m) { return relays(m, m, 5, {}); }},
        {"barrier_gaps", [](const Mesh& m) { return barrier_gaps(m, m, 5, {}); }},
        {"coverage_holes", [](const Mesh& m) { return coverage_holes(m, {}, 5, {}); }},
    };
  }
};

TEST(KeepAlive, IsCalledByWhatReadsAllOfAMesh) {
  Reads reads(inputs::random_graph(2000, inputs::FeatureLength::any, 3));
  Mesh& mesh = reads.mesh;
  Watch seen{.mesh = &mesh};
  for (const auto& [name, read] : reads.all()) {
    mesh.keep_alive({});
    const std::uint64_t answer = read(mesh);
    mesh.keep_alive(hook_of(seen));
    seen.calls = 0;
    EXPECT_EQ(read(mesh), answer) << name;
    EXPECT_GE(seen.calls, mesh.vertex_id_end() / KeepAlive::units_between) << name;
  }
  seal(mesh);
  EXPECT_GT(seen.calls, 0u);
  Mesh again;
  again.keep_alive(hook_of(seen));
  seen.calls = 0;
  ASSERT_EQ(attach(again, reads.bytes()), Status::ok);
  EXPECT_GT(seen.calls, 0u);
}

TEST(KeepAlive, IsCalledWhileSavedBytesAreLookedAt) {
  const Graph graph = inputs::random_graph(2000, inputs::FeatureLength::any, 3);
  Reads reads(graph);
  ASSERT_EQ(reads.mesh.save(reads.saved), Status::ok);
  inputs::OwnedMesh empty(inputs::config_for(graph, 8000));
  Watch seen{.mesh = &*empty};
  empty->keep_alive(hook_of(seen));
  ASSERT_EQ(empty->load(reads.saved, Work{1}), Status::work_limit);
  EXPECT_GE(seen.calls, reads.saved.size() / 32 / KeepAlive::units_between);
}

TEST(KeepAlive, OfAMeshIsNotCalledByThoseWhoReadItsBytes) {
  Reads reads(inputs::random_graph(500, inputs::FeatureLength::any, 3));
  Watch seen{.mesh = &reads.mesh};
  reads.mesh.keep_alive(hook_of(seen));
  MeshReader reader;
  ASSERT_EQ(reader.attach_copy(reads.bytes()), Status::ok);
  for (const auto& [name, read] : reads.all()) static_cast<void>(read(reader.mesh()));
  EXPECT_EQ(seen.calls, 0u);
}

// A walk is counted when it has ended: the hook does not wait for that.
TEST(KeepAliveOfWalks, IsCalledOnTheWay) {
  constexpr std::int32_t count = 2000;
  Graph graph{"two rows", {}, {}};
  for (std::int32_t i = 0; i < count; ++i) graph.nodes.push_back({10 * i, i % 2 * 7});
  const auto mesh = built(graph);
  internal::MeshState& m = *internal::MeshAccess::state(**mesh);
  Watch seen{.mesh = &**mesh};
  const KeepAlive hook = hook_of(seen);
  const auto watched = [&](const std::function<std::uint32_t()>& walk) {
    m.work.start(Work::unlimited(), hook);
    seen.calls = 0;
    const std::uint32_t steps = walk();
    EXPECT_GE(steps, count / 2);
    constexpr std::uint32_t steps_between =
        (KeepAlive::units_between + internal::WalkBound::units_between) / 2;
    EXPECT_GE(seen.calls, steps / steps_between);
  };
  const VertexId first{1}, last{static_cast<IdValue>(count)};
  watched([&] { return find(m, m.at(last), m.topology.edge_at(first), m.work.walk()).steps; });
  watched([&] { return march(m, first, last, m.work.walk()).steps; });
}

// Of many segments the last one alone is to be laid again.
TEST(KeepAliveOfLists, IsCalledWhileAStaleSegmentIsLookedFor) {
  constexpr std::uint32_t count = 2000, columns = 50;
  Graph graph{"apart", {}, {}};
  const auto place = [](std::uint32_t i) {
    return Position{static_cast<std::int32_t>(1000 * (i % columns) + 37 * i % 101),
                    static_cast<std::int32_t>(1000 * (i / columns) + 53 * i % 103)};
  };
  for (std::uint32_t i = 0; i < count; ++i) {
    const Position from = place(i);
    graph.nodes.insert(graph.nodes.end(), {from, {from.x + 100, from.y}});
    graph.features.push_back(between_nodes(2 * std::size_t{i}, 2 * std::size_t{i} + 1));
  }
  const auto mesh = built(graph);
  VertexId id;
  ASSERT_EQ((*mesh)->join({place(count - 1).x + 50, place(count - 1).y + 5}, id), Status::ok);
  ASSERT_FALSE((*mesh)->is_canonical());
  Watch seen{.mesh = &**mesh};
  (*mesh)->keep_alive(hook_of(seen));
  ASSERT_EQ((*mesh)->canonicalize(), Status::ok);
  constexpr std::uint32_t calls = 2 * count / KeepAlive::units_between;
  ASSERT_LT((*mesh)->work_used().units, std::uint64_t{calls} / 2 * KeepAlive::units_between);
  EXPECT_GE(seen.calls, calls);
}

// Whether some Steiner vertices stand again, and others do not yet.
struct Halfway {
  const Mesh* mesh = nullptr;
  std::uint64_t calls = 0;

  void look() noexcept {
    const internal::MeshState& m = state_of(*mesh);
    if (!m.work.is_going_back()) return;
    bool has_detached = false, has_steiner = false;
    for (IdValue i = 1; i < m.vertex_end; ++i) {
      has_detached = has_detached || m.owners[i].role() == internal::Role::detached;
      has_steiner = has_steiner || m.owners[i].role() == internal::Role::steiner;
    }
    calls += has_detached && has_steiner;
  }
};

TEST(KeepAliveOfLists, IsCalledWhileSteinerVerticesComeBack) {
  const Graph graph = inputs::parallels(40, 10, 100'000, 40, 3);
  const auto prepared = [&graph] {
    auto mesh = built(graph, split_default, 20'000);
    VertexId id;
    EXPECT_EQ((*mesh)->join({50'003, 305}, id), Status::ok);
    EXPECT_FALSE((*mesh)->is_canonical());
    return mesh;
  };
  const auto unlimited = prepared(), mesh = prepared();
  ASSERT_GT((*mesh)->steiner_count(), 2 * KeepAlive::units_between);
  ASSERT_EQ((*unlimited)->rebuild(), Status::ok);
  Halfway seen{.mesh = &**mesh};
  (*mesh)->keep_alive(
      {[](void* context) noexcept { static_cast<Halfway*>(context)->look(); }, &seen});
  const Work limit{(*unlimited)->work_needed().units - 1};
  ASSERT_EQ((*mesh)->rebuild(limit), Status::work_limit);
  EXPECT_GE(seen.calls, 2 * (*mesh)->steiner_count() / KeepAlive::units_between - 1);
}

TEST(KeepAlive, IsNotCalledByWhatIsShortNorOnceTakenBack) {
  OwnedMesh mesh(MeshConfig{.vertices_max = 20, .features_max = 4});
  Watch seen{.mesh = &*mesh};
  mesh->keep_alive(hook_of(seen));
  VertexId id;
  ASSERT_EQ(mesh->join({0, 0}, id), Status::ok);
  EXPECT_EQ(seen.calls, 0u);
  mesh->keep_alive({});
  const Graph graph = inputs::random_graph(100, inputs::FeatureLength::any, 3);
  inputs::OwnedMesh large(inputs::config_for(graph, 500));
  large->keep_alive(hook_of(seen));
  large->keep_alive({});
  ASSERT_EQ(large->build(graph.nodes, graph.features), Status::ok);
  EXPECT_EQ(seen.calls, 0u);
}

TEST(KeepAlive, MayChangeAnotherMesh) {
  const Graph graph = inputs::random_graph(100, inputs::FeatureLength::any, 3);
  inputs::OwnedMesh mesh(inputs::config_for(graph, 500)), alone(inputs::config_for(graph, 500));
  ASSERT_EQ(alone->build(graph.nodes, graph.features), Status::ok);
  OwnedMesh other(MeshConfig{.vertices_max = 2000, .features_max = 0});
  mesh->keep_alive({[](void* of) noexcept {
                      Mesh& another = *static_cast<Mesh*>(of);
                      const auto count = static_cast<std::int32_t>(another.node_count());
                      VertexId id;
                      EXPECT_EQ(another.join({count, count * count % 97}, id), Status::ok);
                    },
                    &*other});
  ASSERT_EQ(mesh->build(graph.nodes, graph.features), Status::ok);
  EXPECT_EQ(mesh->hash(), alone->hash());
  EXPECT_GT(other->node_count(), 50u);
  EXPECT_TRUE(audit(*other));
}

#ifdef ETCM_CHECK_ARGUMENTS
TEST(KeepAliveDeathTest, CannotChangeTheMesh) {
  testing::GTEST_FLAG(death_test_style) = "threadsafe";
  const Graph graph = inputs::random_graph(100, inputs::FeatureLength::any, 3);
  inputs::OwnedMesh mesh(inputs::config_for(graph, 500));
  for (const auto call : {+[](void* of) noexcept { static_cast<Mesh*>(of)->clear(); },
                          +[](void* of) noexcept {
                            VertexId id;
                            static_cast<void>(static_cast<Mesh*>(of)->join({1, 1}, id));
                          },
                          +[](void* of) noexcept {
                            static_cast<void>(DryRun(*static_cast<Mesh*>(of)).leave(VertexId{1}));
                          }}) {
    mesh->keep_alive({call, &*mesh});
    EXPECT_DEATH(static_cast<void>(mesh->build(graph.nodes, graph.features)), "");
  }
}
#endif

}  // namespace
}  // namespace etcm::test
