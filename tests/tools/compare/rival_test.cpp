// What the systems of the paper share: a rule sees the endpoints as they were given, and the loop
// looks again only where something has changed.
#include "compare/systems/rival.h"

#include <gtest/gtest.h>

#include "compare/measurement.h"
#include "compare/variants.h"
#include "hand_made.h"
#include "inputs/random_graph.h"

namespace etcm::compare {
namespace {

using inputs::FeatureLength;

const inputs::Graph one_gate = one_feature({{400, 240}, {400, -240}});

TEST(Rival, ARuleSeesTheEndThatWasGivenFirst) {
  for (const bool backwards : {false, true}) {
    const inputs::Graph graph = backwards ? exchanged(one_gate) : one_gate;
    std::vector<Point> starts;
    const auto rule = [&](const MissingSubsegment& missing, std::vector<Parameter>& places) {
      starts.push_back(missing.at(0));
      EXPECT_EQ(missing.at(0), to_point(missing.site().from));
      EXPECT_EQ(missing.mesh->at(missing.subsegment.head), missing.at(missing.head));
      EXPECT_EQ(missing.mesh->at(missing.subsegment.tail), missing.at(missing.tail));
      split_in_the_middle(missing, places);
    };
    run_rival(graph, {.split = rule}, Depth::times);
    ASSERT_EQ(starts.size(), 1u);
    EXPECT_EQ(starts[0], to_point(graph.nodes[backwards ? 1 : 0]));
  }
}

TEST(Rival, ReachesAreThoseOfTheSameEndsFromEitherSide) {
  std::vector<SplitSite> sites;
  const auto rule = [&](const MissingSubsegment& missing, std::vector<Parameter>& places) {
    sites.push_back(missing.site());
    split_in_the_middle(missing, places);
  };
  run_rival(one_gate, {.split = rule}, Depth::times);
  run_rival(exchanged(one_gate), {.split = rule}, Depth::times);
  ASSERT_EQ(sites.size(), 2u);
  EXPECT_EQ(sites[0].feasible_head, parameter_end - sites[1].feasible_tail);
  EXPECT_EQ(sites[0].feasible_tail, parameter_end - sites[1].feasible_head);
}

// A rule that knows its direction must be seen to change, or the criterion could not fail.
TEST(Rival, ARuleThatKnowsItsDirectionDoesNotSurviveTheExchange) {
  const auto limit = std::chrono::seconds(20);
  const auto graph = inputs::random_graph(60, FeatureLength::any, 1);
  const System near_the_first{
      "first", "first", [](const inputs::Graph& g, Depth depth) {
        const auto rule = [](const MissingSubsegment& missing, std::vector<Parameter>& places) {
          places.push_back(missing.head + (missing.tail - missing.head) / 3);
        };
        return run_rival(g, {.split = rule}, depth);
      }};
  const System middle{"middle", "middle", [](const inputs::Graph& g, Depth depth) {
                        return run_rival(g, {.split = split_in_the_middle}, depth);
                      }};
  const Measurement changed = measure(near_the_first, graph, limit);
  EXPECT_EQ(changed.verdict, Verdict::ok);
  EXPECT_FALSE(changed.survives_exchange);
  const Measurement same = measure(middle, graph, limit);
  EXPECT_EQ(same.verdict, Verdict::ok);
  EXPECT_TRUE(same.survives_exchange);
}

TEST(Rival, TheMiddleIsTheSamePlaceFromBothEnds) {
  for (const Parameter a : {0, 1, 2, 3, 1000}) {
    for (Parameter b = a + 2; b < a + 20; ++b) {
      EXPECT_EQ(middle_of(a, b), parameter_end - middle_of(parameter_end - b, parameter_end - a));
      EXPECT_LE(std::abs(2 * middle_of(a, b) - a - b), 1);
    }
  }
}

// What the rules need does not depend on how the loop walks: recorded from a loop that began at the
// first node of a segment each time.
TEST(Rival, NeedsThePointsOfALoopThatWalksEachSegmentFromItsStart) {
  const auto graph = inputs::random_graph(1000, FeatureLength::any, 1);
  EXPECT_EQ(run_tsai(graph, Depth::times).added, 2896u);
  EXPECT_EQ(run_sapidis_perucchio(graph, Depth::times).added, 2039u);
  EXPECT_EQ(run_diametral(graph, Depth::times).added, 3165u);
  EXPECT_EQ(run_wei_first_circle(graph, Depth::times).added, 1654u);
  EXPECT_EQ(run_etcm(graph, Depth::times).added, 1302u);
}

// Each point makes two subsegments of one, and each subsegment that breaks is looked at once more,
// with what lies between it and the next that broke of the same feature.
TEST(Rival, LooksAgainOnlyWhereSomethingBroke) {
  const auto graph = inputs::random_graph(1000, FeatureLength::any, 1);
  for (const auto run : {run_tsai, run_sapidis_perucchio, run_wei, run_etcm, run_lu}) {
    const Attempt attempt = run(graph, Depth::times);
    EXPECT_LT(attempt.looked_at, 4u * attempt.added + graph.features.size());
  }
}

TEST(Rival, AStackOfBrokenFeaturesEndsTooAndIsStable) {
  const auto graph = inputs::random_graph(300, FeatureLength::any, 1);
  const Attempt stack = run_etcm_stack(graph, Depth::whole);
  EXPECT_EQ(stack.verdict, Verdict::ok);
  EXPECT_NE(stack.hash, run_etcm(graph, Depth::whole).hash);
  EXPECT_EQ(stack.hash, run_etcm_stack(exchanged(graph), Depth::whole).hash);
}

}  // namespace
}  // namespace etcm::compare
