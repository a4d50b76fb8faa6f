// Which segments depend on which: rings that join and do not part again until they are stale.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <set>
#include <vector>

#include "conforming/canonical.h"
#include "conforming/group.h"
#include "conforming/influence.h"
#include "inputs/patterns.h"
#include "inputs/random.h"
#include "inputs/random_graph.h"
#include "support/meshes.h"
#include "triangulation/change.h"
#include "triangulation/mesh_state.h"

namespace etcm::test {
namespace {

using internal::MeshState;
using internal::SegmentId;

constexpr IdValue count = 24;

// Features that stand apart, so that none depends on another.
class Dependence : public testing::Test {
 protected:
  Dependence() {
    Graph graph{"apart", {}, {}};
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(count); ++i) {
      graph.nodes.push_back({0, 100 * i});
      graph.nodes.push_back({10, 100 * i});
      graph.features.push_back(between_nodes(2 * std::size_t(i), 2 * std::size_t(i) + 1));
    }
    mesh_ = built(graph);
    state().work.start(Work::unlimited(), nobody_);
  }

  MeshState& state() { return *internal::MeshAccess::state(**mesh_); }

  std::set<IdValue> ring_of(IdValue of) {
    std::set<IdValue> ring;
    for (IdValue i = of; ring.insert(i).second;)
      i = state().segment(SegmentId{i}).next_dependent.value;
    return ring;
  }

  std::set<IdValue> stale() {
    std::set<IdValue> found;
    for (IdValue i = 0; i < count; ++i) {
      if (is_stale(state(), SegmentId{i})) found.insert(i);
    }
    return found;
  }

  void join_all(std::initializer_list<IdValue> members) {
    for (const IdValue i : members) {
      make_dependent(state(), SegmentId{*members.begin()}, SegmentId{i});
    }
  }

  KeepAlive nobody_;
  std::unique_ptr<OwnedMesh> mesh_;
};

TEST_F(Dependence, JoinsRingsAndNeverPartsThem) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    inputs::Random random(seed);
    for (IdValue i = 0; i < count; ++i) make_stale(state(), SegmentId{i});
    std::vector<std::set<IdValue>> expected(count);
    for (IdValue i = 0; i < count; ++i) expected[i] = {i};
    for (int step = 0; step < 40; ++step) {
      const auto a = static_cast<IdValue>(random.index(count));
      const auto b = static_cast<IdValue>(random.index(count));
      make_dependent(state(), SegmentId{a}, SegmentId{b});
      std::set<IdValue> joined = expected[a];
      joined.insert(expected[b].begin(), expected[b].end());
      for (const IdValue i : joined) expected[i] = joined;
      for (IdValue i = 0; i < count; ++i) {
        ASSERT_EQ(ring_of(i), expected[i]) << "seed " << seed << ", step " << step;
      }
    }
  }
}

TEST_F(Dependence, MakesStaleAllOfARingAndNobodyElse) {
  join_all({3, 7, 12});
  join_all({4, 8});
  make_stale(state(), SegmentId{7});
  EXPECT_EQ(stale(), (std::set<IdValue>{3, 7, 12}));
  EXPECT_EQ(state().stale_count, 3u);
  // Laid again, they depend on what is found then.
  EXPECT_EQ(ring_of(3), (std::set<IdValue>{3}));
  make_stale(state(), SegmentId{12});
  EXPECT_EQ(state().stale_count, 3u) << "it was stale";
  make_canonical(state(), SegmentId{12});
  make_canonical(state(), SegmentId{12});
  EXPECT_EQ(stale(), (std::set<IdValue>{3, 7}));
  EXPECT_EQ(state().stale_count, 2u);
}

TEST_F(Dependence, OfASegmentThatGoesIsRememberedByThoseThatStay) {
  join_all({3, 7, 12});
  forget_segment(state(), SegmentId{7});
  EXPECT_EQ(stale(), (std::set<IdValue>{3, 12}));
  EXPECT_EQ(state().stale_count, 2u);
  EXPECT_EQ(ring_of(7), (std::set<IdValue>{7}));
}

TEST_F(Dependence, MakesAllStaleWhereItIsNotKnown) {
  state().knows_dependence = false;
  make_stale(state(), SegmentId{3});
  EXPECT_EQ(stale().size(), count);
}

// Segments that stand alone are laid twice, and what stood there first is looked around.
TEST(DependenceAfterABuild, IsKnownOfShortFeaturesWhoeverIsLaidTwice) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto mesh = built(inputs::random_graph(300, inputs::FeatureLength::in_reach, seed));
    ASSERT_GT((*mesh)->steiner_count(), 0u);
    EXPECT_TRUE(internal::MeshAccess::state(**mesh)->knows_dependence) << "seed " << seed;
  }
}

// Beside many parallels there is too much to look at when a vertex is taken out again.
TEST(DependenceAfterABuild, IsNotKnownWhereThereWasTooMuchToLookAt) {
  const auto mesh = built(inputs::parallels(40, 30, 100'000, 40, 3), split_default, 20'000);
  EXPECT_FALSE(state_of(**mesh).knows_dependence);
}

bool is_stale(const Mesh& mesh, IdValue feature) {
  return internal::is_stale(state_of(mesh), SegmentId{feature});
}

void on_nobody(internal::Change&, SegmentId, SegmentId) noexcept {}

// Where there is too much to look at, nobody knows who else belongs there.
TEST(DependenceOfAGroup, IsGivenUpWhereOfAVertexThatIsLaidItIsNotKnown) {
  const KeepAlive nobody;
  std::uint32_t known = 0, unknown = 0;
  for (const Graph& graph : {inputs::random_graph(250, inputs::FeatureLength::any, 3),
                             inputs::parallels(40, 10, 100'000, 40, 3)}) {
    const auto mesh = built(graph, split_default, 20'000);
    MeshState& m = state_of(**mesh);
    m.work.start(Work::unlimited(), nobody);
    for (const VertexId v : steiner_vertices(**mesh)) {
      internal::Change change(m, internal::Change::Extent::group);
      change.group.first = internal::end_of_group;
      change.group.work_left = 1000;
      const bool is_known = find_influenced(change, v, SegmentId::none(), on_nobody);
      static_cast<void>(stays_in_group(change, v));
      ASSERT_EQ(change.group.work_left != 0, is_known) << graph.name << ", vertex " << v.value;
      ++(is_known ? known : unknown);
    }
  }
  EXPECT_GT(known, 100u);
  EXPECT_GT(unknown, 100u);
}

// What was looked at together is looked at afresh by the next call.
TEST(DependenceAfterARefusal, LeavesNoGroupBehind) {
  for (const auto length : {inputs::FeatureLength::any, inputs::FeatureLength::in_reach}) {
    const auto mesh = grown(inputs::random_graph(100, length, 5));
    const MeshState& m = state_of(**mesh);
    std::uint32_t refused = 0;
    for (std::uint64_t units = 1; !(*mesh)->is_canonical(); units += 1 + units / 16) {
      ASSERT_LT(units, 100'000'000u) << "no limit is enough";
      refused += (*mesh)->canonicalize(Work{units}) == Status::work_limit;
      for (IdValue i = 0; i < m.segment_end; ++i) {
        const SegmentId next = m.segment(SegmentId{i}).next_in_group;
        ASSERT_TRUE(next == internal::not_listed || next.is_none()) << units;
      }
    }
    EXPECT_GT(refused, 20u);
  }
}

// Another feature at an end sees with whom it shares the end, and where that one leads.
TEST(DependenceOnWhoMeets, MakesStaleWhoEndsWhereAFeatureDoesThatLosesANode) {
  Graph graph{"", {}, {}};
  graph.nodes = {{0, 0}, {500, 0}, {1000, 0}, {-500, 30}, {1500, 30}, {250, 400}, {250, -400}};
  graph.nodes.insert(graph.nodes.end(), {{750, 400}, {750, -400}, {5000, 5000}, {5100, 5000}});
  graph.features = {between_nodes(0, 2), between_nodes(3, 0), between_nodes(2, 4),
                    between_nodes(9, 10)};
  const auto mesh = built(graph);
  ASSERT_EQ((*mesh)->steiner_count(), 0u);
  ASSERT_EQ((*mesh)->leave(vertex_of(1)), Status::ok);
  EXPECT_TRUE(is_stale(**mesh, 0));
  EXPECT_TRUE(is_stale(**mesh, 1)) << "where it begins";
  EXPECT_TRUE(is_stale(**mesh, 2)) << "where it ends";
  EXPECT_FALSE(is_stale(**mesh, 3));
}

TEST(DependenceOnWhoMeets, MakesStaleWhoEndsWhereAFeatureDoesThatGetsANode) {
  Graph graph{"", {}, {}};
  graph.nodes = {{0, 0}, {1000, 0}, {-500, 30}, {1500, 30}, {250, 600}, {250, -600}};
  graph.nodes.insert(graph.nodes.end(), {{750, 600}, {750, -600}, {5000, 5000}, {5100, 5000}});
  graph.features = {between_nodes(0, 1), between_nodes(2, 0), between_nodes(1, 3),
                    between_nodes(8, 9)};
  const auto mesh = built(graph);
  ASSERT_EQ((*mesh)->steiner_count(), 0u);
  VertexId v;
  ASSERT_EQ((*mesh)->join({500, 0}, v), Status::ok);
  EXPECT_TRUE(is_stale(**mesh, 0));
  EXPECT_TRUE(is_stale(**mesh, 1)) << "where it begins";
  EXPECT_TRUE(is_stale(**mesh, 2)) << "where it ends";
  EXPECT_FALSE(is_stale(**mesh, 3));
}

// What stood there because of it is looked for around its place when the mesh is made canonical.
TEST(DependenceOnPlaces, KeepsThoseOfSteinerVerticesThatAreNeedlessNow) {
  Graph graph{"", {{0, 0}, {1000, 0}, {500, 5}, {300, -400}}, {between_nodes(0, 1)}};
  const auto mesh = built(graph);
  std::set<Point> gone{(*mesh)->point(vertex_of(2))};
  for (const VertexId v : steiner_vertices(**mesh)) gone.insert((*mesh)->point(v));
  ASSERT_GT(gone.size(), 1u);
  ASSERT_EQ((*mesh)->leave(vertex_of(2)), Status::ok);
  ASSERT_EQ((*mesh)->steiner_count(), 0u);
  const MeshState& m = state_of(**mesh);
  ASSERT_FALSE(m.is_all_stale);
  EXPECT_EQ(std::set<Point>(m.places, m.places + m.place_count), gone);
}

}  // namespace
}  // namespace etcm::test
