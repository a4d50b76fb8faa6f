// The paper's sections 4 and 5: the least for a feature alone, and judgments counted.
#include <gtest/gtest.h>

#include "compare/judgments.h"
#include "compare/lone.h"
#include "hand_made.h"

namespace etcm::compare {
namespace {

TEST(LeastPoints, AreWorkedOutFromTheNodes) {
  // See etcm_rule_test.cpp: one place finishes both ends; or two are needed, for the circles do not
  // overlap.
  EXPECT_EQ(least_points(one_feature({{400, 240}, {400, -240}})), 1u);
  EXPECT_EQ(least_points(one_feature({{200, 100}, {200, -100}, {800, 100}, {800, -44}})), 2u);
  // Seen under 2 atan(500 / 600) from both sides, together under 180 degrees.
  EXPECT_EQ(least_points(one_feature({{500, 600}, {500, -600}})), 0u);
  EXPECT_EQ(least_points(one_feature({{500, 1}, {400, 1}})), 0u);
}

TEST(LeastPoints, AreReachedByFinishingFromTheEndsAndByNoRuleUndercut) {
  const std::vector<System> systems = lone_systems();
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    const LoneResult only_vertex = measure_lone(200, seed);
    ASSERT_EQ(only_vertex.added.size(), systems.size());
    for (std::size_t i = 0; i < systems.size(); ++i) {
      ASSERT_NE(only_vertex.added[i], lone_failed) << systems[i].label;
      EXPECT_GE(only_vertex.added[i], only_vertex.least) << systems[i].label;
      const bool finishes_from_the_ends = systems[i].key == etcm_key || systems[i].key == "wei" ||
                                          systems[i].key == "wei-first" ||
                                          systems[i].key == "paper-policy";
      if (finishes_from_the_ends) {
        EXPECT_EQ(only_vertex.added[i], only_vertex.least) << systems[i].label;
      }
    }
  }
}

TEST(LoneGraph, HasOneFeature) {
  EXPECT_EQ(lone_graph(100, 1).features.size(), 1u);
  EXPECT_EQ(lone_graph(100, 1).nodes.size(), 100u);
}

// Two triangles, one at each end: the first is found at once, and of the two the point's place is
// known after one judgment.
TEST(Judgments, OfOneGate) {
  const JudgmentTally tally = count_judgments(one_feature({{400, 240}, {400, -240}}));
  EXPECT_EQ(tally.subsegments, 1u);
  EXPECT_EQ(tally.crossed, 2u);
  EXPECT_EQ(tally.around, 1u);
  EXPECT_EQ(tally.intersections, 1u);
  EXPECT_EQ(tally.points, 1u);
  EXPECT_EQ(tally.searched, 2u);
  EXPECT_EQ(tally.containment, 1u);
}

// Two gates: four triangles, and two between 250 and the tail once the first point is in. 250 lies
// behind the first gate in the second or third triangle; 793 before the second gate.
TEST(Judgments, OfTwoGates) {
  const JudgmentTally tally =
      count_judgments(one_feature({{200, 100}, {200, -100}, {800, 100}, {800, -44}}));
  EXPECT_EQ(tally.subsegments, 1u);  // the remainder is not looked for again
  EXPECT_EQ(tally.crossed, 4u);
  // One at the endpoint, one or two for each of the two in the middle.
  EXPECT_GE(tally.intersections, 1u + 2u);
  EXPECT_LE(tally.intersections, 1u + 4u);
  EXPECT_EQ(tally.points, 2u);
  EXPECT_EQ(tally.searched, 4u + 2u);
  EXPECT_EQ(tally.containment, 2u + 1u);
}

TEST(Judgments, StayWithinThePapersFormulas) {
  const JudgmentTally tally =
      count_judgments(inputs::random_graph(300, inputs::FeatureLength::any, 1));
  EXPECT_GT(tally.subsegments, 45u);  // features, and broken ones again
  EXPECT_LE(tally.intersections, tally.around + 2 * (tally.crossed - 2 * tally.subsegments));
  EXPECT_LE(tally.containment, tally.searched - tally.points);
}

}  // namespace
}  // namespace etcm::compare
