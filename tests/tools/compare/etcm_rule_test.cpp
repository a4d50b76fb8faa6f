// The paper's rule where the places can be worked out by hand: Algorithm 2, word for word.
#include <gtest/gtest.h>

#include "compare/systems/etcm_literal.h"
#include "compare/systems/system.h"
#include "compare/variants.h"
#include "hand_made.h"
#include "inputs/owned_mesh.h"

namespace etcm::compare {
namespace {

struct Split {
  internal::SegmentId feature;
  Point at;
};

// The places in the order in which the rule chose them.
std::vector<Split> splits_of(const inputs::Graph& graph) {
  std::vector<Split> splits;
  const auto rule = [&](const MissingSubsegment& missing, std::vector<Parameter>& places) {
    split_literally(missing, places);
    splits.push_back({missing.segment, missing.at(places.front())});
  };
  EXPECT_EQ(run_rival(graph, {.split = rule}, Depth::whole).verdict, Verdict::ok);
  return splits;
}

void expect_on_the_axis(const std::vector<Split>& splits, const std::vector<double>& x) {
  ASSERT_EQ(splits.size(), x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_NEAR(units(splits[i].at.x), x[i], one_step) << "split " << i;
    EXPECT_EQ(splits[i].at.y, 0);
  }
}

// One gate at 400, P = 240 * 240 = 57 600. Q1 = 400 + P / 400 = 544, Q2 = 400 - P / 600 = 304: they
// overlap, so the middle, 424, finishes both ends.
const inputs::Graph overlapping = one_feature({{400, 240}, {400, -240}});

// Gates at 200 (P = 10 000) and 800 (P = 100 * 44 = 4400). Q1 = 200 + 10 000 / 200 = 250 and
// Q2 = 800 - 4400 / 200 = 778 do not overlap; the head's part, 250, is longer than the tail's, 222.
// What is left, from 250, is asked again: Q1 = 800 + 4400 / 550 = 808 and Q2 = 778 overlap, and the
// middle is 793.
const inputs::Graph longer_at_the_head =
    one_feature({{200, 100}, {200, -100}, {800, 100}, {800, -44}});

// The same, mirrored: Q1 = 222, Q2 = 750, and 250 at the tail is longer. What is left, up to 750:
// Q1 = 222, Q2 = 200 - 4400 / 550 = 192, middle 207.
const inputs::Graph longer_at_the_tail =
    one_feature({{200, 100}, {200, -44}, {800, 100}, {800, -100}});

TEST(EtcmRule, TakesTheMiddleOfTheOverlap) { expect_on_the_axis(splits_of(overlapping), {424}); }

TEST(EtcmRule, TakesQ1WhereTheHeadReachesFurther) {
  expect_on_the_axis(splits_of(longer_at_the_head), {250, 793});
}

TEST(EtcmRule, TakesQ2WhereTheTailReachesFurther) {
  expect_on_the_axis(splits_of(longer_at_the_tail), {750, 207});
}

// Both gates have P = 10 000: Q1 = 250 and Q2 = 750 are equally far from their ends, and step 5-1
// says >=: the end that was given first. So of a tie the mesh is not stable.
TEST(EtcmRule, GivesATieToTheEndThatWasGivenFirst) {
  const inputs::Graph tied = one_feature({{200, 100}, {200, -100}, {800, 100}, {800, -100}});
  // Then Q1 = 800 + 10 000 / 550 = 818.18..., Q2 = 750; mirrored 181.81... and 250.
  expect_on_the_axis(splits_of(tied), {250, (750 + 800 + 10'000.0 / 550) / 2});
  expect_on_the_axis(splits_of(exchanged(tied)), {750, (250 + 200 - 10'000.0 / 550) / 2});
  EXPECT_NE(run_etcm(tied, Depth::whole).hash, run_etcm(exchanged(tied), Depth::whole).hash);
}

// The first feature, from (0, 0) to (1000, 0), is an edge when the second comes, from (-100, 150)
// to (1100, 150). That one crosses the edges from (500, 550) to both ends of the first. With
// (-100, 150) as origin the circle through (0, 0), that is (100, -150), and (500, 550), that is
// (600, 400), is x^2 + y^2 - 700 x - 250 y = 0: Q1 is 700 along, Q2 by symmetry 500, the middle
// 600: (500, 150). From there the first feature is seen under 2 atan(500 / 150) = 146.6 degrees,
// from (500, -1000) under 53.1: together more than 180, so it is no edge any longer. It comes back:
// a gate at 500 with P = 150 * 1000, Q1 = 800, Q2 = 200, middle 500.
TEST(EtcmRule, ABrokenFeatureComesBack) {
  inputs::Graph graph = one_feature({{-100, 150}, {1100, 150}, {500, 550}, {500, -1000}});
  EXPECT_TRUE(splits_of(graph).empty());
  graph.features.push_back(inputs::between_nodes(2, 3));
  const std::vector<Split> splits = splits_of(graph);
  ASSERT_EQ(splits.size(), 2u);
  EXPECT_EQ(splits[0].feature, internal::SegmentId{1});
  EXPECT_NEAR(units(splits[0].at.x), 500, one_step);
  EXPECT_EQ(splits[0].at.y, to_point({0, 150}).y);
  EXPECT_EQ(splits[1].feature, internal::SegmentId{0});
  EXPECT_NEAR(units(splits[1].at.x), 500, one_step);
  EXPECT_EQ(splits[1].at.y, 0);
}

// Of one feature nothing is pruned and no order is left to choose, so the library's policy `paper`
// finds the same places.
TEST(EtcmRule, IsThatOfTheLibrarysPaperPolicyForAFeatureAlone) {
  for (const inputs::Graph& graph : {overlapping, longer_at_the_head, longer_at_the_tail}) {
    const std::vector<Point> literal = added_points(run_etcm(graph, Depth::whole));
    const std::vector<Point> built = added_points(run_paper_policy(graph, Depth::whole));
    ASSERT_EQ(literal.size(), built.size());
    for (std::size_t i = 0; i < literal.size(); ++i) {
      EXPECT_NEAR(units(literal[i].x), units(built[i].x), one_step);
    }
  }
}

}  // namespace
}  // namespace etcm::compare
