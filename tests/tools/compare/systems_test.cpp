// Each system is the one that its name says.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "compare/measurement.h"
#include "compare/variants.h"
#include "hand_made.h"
#include "inputs/patterns.h"
#include "inputs/random_graph.h"

namespace etcm::compare {
namespace {

using inputs::FeatureLength;

TEST(Systems, EveryMeshPassesItsAudit) {
  for (const auto& graph :
       {inputs::random_graph(150, FeatureLength::any, 3),
        inputs::random_graph(150, FeatureLength::in_reach, 3), inputs::comb(20, 10, 1000, 333)}) {
    for (const auto& systems : {all_systems(), other_readings()}) {
      for (const System& system : systems) {
        EXPECT_EQ(system.run(graph, Depth::whole).verdict, Verdict::ok)
            << system.label << " on " << graph.name;
      }
    }
  }
}

TEST(Systems, TsaiPutsAPointOnTheCrossing) {
  const Attempt attempt = run_tsai(one_feature({{300, 100}, {500, -100}}), Depth::whole);
  ASSERT_EQ(attempt.added, 1u);
  // The one edge in the way runs from (300, 100) to (500, -100).
  EXPECT_EQ(added_points(attempt)[0].y, 0);
  // The nearest place of the feature's grid, whose steps are 1000 sub-units here.
  EXPECT_NEAR(static_cast<double>(added_points(attempt)[0].x - to_point({400, 0}).x), 0, 500);
}

TEST(Systems, SapidisAndPerucchioTakeTheMiddle) {
  const Attempt attempt =
      run_sapidis_perucchio(one_feature({{490, 200}, {510, -200}}), Depth::whole);
  ASSERT_EQ(attempt.added, 1u);
  EXPECT_EQ(added_points(attempt)[0], to_point({500, 0}));
}

// One gate at 400 (see hand_made.h), P = 57 600: Q1 = 544 and Q2 = 304 overlap.
TEST(Systems, WeiFinishesInTheOverlap) {
  const inputs::Graph graph = one_feature({{400, 240}, {400, -240}});
  const std::vector<Point> points = added_points(run_wei(graph, Depth::whole));
  ASSERT_EQ(points.size(), 1u);
  EXPECT_NEAR(units(points[0].x), 424, one_step);
  const std::vector<Point> first_circle = added_points(run_wei_first_circle(graph, Depth::whole));
  ASSERT_EQ(first_circle.size(), 1u);
  EXPECT_NEAR(units(first_circle[0].x), 544, one_step);
}

// Gates at 200 (Q1 = 222) and 800 (Q2 = 750): the tail's circle reaches further, but it is the end
// that was given first that is finished.
TEST(Systems, WeiStartsAtTheEndThatWasGivenFirst) {
  const inputs::Graph graph = one_feature({{200, 100}, {200, -44}, {800, 100}, {800, -100}});
  const std::vector<Point> forth = added_points(run_wei(graph, Depth::whole));
  const std::vector<Point> back = added_points(run_wei(exchanged(graph), Depth::whole));
  ASSERT_EQ(forth.size(), 2u);
  ASSERT_EQ(back.size(), 2u);
  EXPECT_NEAR(units(forth[0].x), 222, one_step);
  EXPECT_NEAR(units(back[0].x), 750, one_step);
  EXPECT_NE(forth, back);
}

// Six triangles in the way, one at each end and two between each two of three gates: four parts.
TEST(Systems, LuMakesTwoEqualPartsForEveryThreeTriangles) {
  const inputs::Graph graph =
      one_feature({{200, 50}, {200, -50}, {520, 60}, {520, -50}, {800, 50}, {800, -60}});
  const std::vector<Point> points = added_points(run_lu(graph, Depth::whole));
  ASSERT_GE(points.size(), 3u);
  const auto has = [&](double x) {
    return std::any_of(points.begin(), points.end(),
                       [&](const Point& point) { return std::abs(units(point.x) - x) < one_step; });
  };
  EXPECT_TRUE(has(250));
  EXPECT_TRUE(has(500));
  EXPECT_TRUE(has(750));
}

TEST(Systems, DiametralLeavesNoVertexInADiametralCircle) {
  // Near enough to be inside the circle over the feature, but not in the way of the edge.
  const inputs::Graph graph = one_feature({{500, 100}, {500, -5000}});
  EXPECT_EQ(run_sapidis_perucchio(graph, Depth::whole).added, 0u);
  EXPECT_GT(run_diametral(graph, Depth::whole).added, 0u);
}

TEST(Systems, PruningOnlyTakesOut) {
  const inputs::Graph graph = inputs::random_graph(300, FeatureLength::any, 5);
  for (const System& system : all_systems()) {
    const Attempt attempt = system.run(graph, Depth::whole);
    EXPECT_LE(attempt.added_after_pruning, attempt.added) << system.label;
  }
}

TEST(Systems, OneThatDoesNotEndFailsAloneAndInTime) {
  const System sleeper{"sleeper", "sleeper", [](const inputs::Graph&, Depth) -> Attempt {
                         while (true) pause();
                       }};
  const Measurement measured = measure(sleeper, inputs::random_graph(20, FeatureLength::any, 1),
                                       std::chrono::milliseconds(50));
  EXPECT_EQ(measured.verdict, Verdict::not_ended);
}

TEST(Systems, AreFoundByKey) {
  const std::vector<std::string> keys{"default", "tsai"};
  const std::vector<System> systems = systems_named(keys);
  ASSERT_EQ(systems.size(), 2u);
  EXPECT_EQ(systems[0].key, "tsai");
  EXPECT_EQ(systems[1].key, "default");
  EXPECT_EQ(systems_named({}).size(), all_systems().size());
  ASSERT_EQ(systems_named(std::vector<std::string>{"wei-first"}).size(), 1u);
  EXPECT_THROW(systems_named(std::vector<std::string>{"ruppert"}), std::invalid_argument);
}

TEST(Variants, AreTheSameGraphGivenOtherwise) {
  const inputs::Graph graph = inputs::random_graph(100, FeatureLength::any, 1);
  const std::uint64_t hash = run_default(graph, Depth::whole).hash;
  EXPECT_EQ(run_default(exchanged(graph), Depth::whole).hash, hash);
  EXPECT_EQ(run_default(shuffled(graph, 7), Depth::whole).hash, hash);
  EXPECT_NE(shuffled(graph, 7).nodes, graph.nodes);
}

}  // namespace
}  // namespace etcm::compare
