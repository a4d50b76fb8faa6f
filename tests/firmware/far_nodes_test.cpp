// Which nodes stand far from all others.
#include "firmware/publish/far_nodes.h"

#include <gtest/gtest.h>

#include <vector>

namespace etcm::firmware {
namespace {

const SitePlane metres{.unit_length = 1'000'000'000, .metres = 1'000'000'000};

using Rows = std::vector<std::size_t>;

Settings on(const SitePlane& plane) {
  Settings settings;
  settings.site.unit_length = plane.unit_length;
  settings.site.metres = plane.metres;
  return settings;
}

// Rows of those that are far, from this.
Rows far_from(FarFrom what, const std::vector<Position>& places, const Settings& settings) {
  Snapshot snapshot;
  for (const Position place : places) {
    SnapshotVertex& vertex = snapshot.vertices.emplace_back();
    vertex.kind = VertexKind::node;
    vertex.point = to_point(place);
  }
  FarNodes nodes(static_cast<std::uint32_t>(places.size()));
  nodes.set_site(settings);
  nodes.mark(snapshot);
  Rows rows;
  std::size_t count = 0;
  for (std::size_t row = 0; row < snapshot.vertices.size(); ++row) {
    if (snapshot.vertices[row].far_from != FarFrom::nothing) ++count;
    if (snapshot.vertices[row].far_from == what) rows.push_back(row);
  }
  EXPECT_EQ(snapshot.far_count, count);
  return rows;
}

// From others.
Rows far(const std::vector<Position>& places, const SitePlane& plane = metres) {
  return far_from(FarFrom::others, places, on(plane));
}
// From one another: nobody can say which of them is wrong.
Rows apart(const std::vector<Position>& places) {
  return far_from(FarFrom::another, places, on(metres));
}
Rows off_site(const std::vector<Position>& places, const Settings& settings) {
  return far_from(FarFrom::site, places, settings);
}

const std::vector<Position> yard = {{0, 0}, {100, 0}, {100, 100}, {0, 100}, {50, 60}};

std::vector<Position> yard_and(Position other) {
  std::vector<Position> places = yard;
  places.push_back(other);
  return places;
}

TEST(FarNodes, OneAtAnotherPlaceOfTheEarthIs) {
  EXPECT_EQ(far(yard), Rows{});
  EXPECT_EQ(far(yard_and({900'000, 0})), Rows{5});
  EXPECT_EQ(far(yard_and({50, -7'000'000})), Rows{5});
  EXPECT_EQ(far({{0, 0}, {100, 0}, {900'000, 0}, {0, 100}}), Rows{2}) << "one of four";
}

TEST(FarNodes, AStationOutsideIsNot) {
  EXPECT_EQ(far(yard_and({19'000, 0})), Rows{});
  EXPECT_EQ(far(yard_and({20'500, 0})), Rows{5});
}

TEST(FarNodes, OfALongSiteNoneIs) {
  std::vector<Position> pipe;
  for (std::int32_t at = 0; at < 40; ++at) pipe.push_back({at * 10'000, at % 3 * 500});
  EXPECT_EQ(far(pipe), Rows{});
  pipe.push_back({1'000'000, 0});
  EXPECT_EQ(far(pipe), Rows{}) << "less than 20 times as far as three quarters";
  pipe.push_back({-16'000'000, 0});
  EXPECT_EQ(far(pipe), Rows{41});
}

TEST(FarNodes, OfTwoPlacesNeitherIs) {
  std::vector<Position> both = yard;
  for (const Position place : yard) both.push_back({place.x + 900'000, place.y});
  EXPECT_EQ(far(both), Rows{});
}

TEST(FarNodes, OfThreeNobodyCanSay) {
  EXPECT_EQ(far({{0, 0}, {100, 0}, {900'000, 0}}), Rows{});
  EXPECT_EQ(far({}), Rows{});
}

TEST(FarNodes, OfTwoThatNoSiteHasBothAreTold) {
  EXPECT_EQ(apart({{0, 0}, {1'000'000, 1'000'000}}), Rows{});
  EXPECT_EQ(apart({{0, 0}, {1'000'100, 0}}), (Rows{0, 1}));
  EXPECT_EQ(apart({{0, 0}, {0, -6'000'000}}), (Rows{0, 1}));
  EXPECT_EQ(apart({{0, 0}, {100, 0}, {6'000'000, 0}}), (Rows{0, 1, 2}))
      << "two with the same mistake stand together as well as two that are right";
  EXPECT_EQ(apart({{6'000'000, 0}}), Rows{});
}

TEST(FarNodes, TwoOfFourAreToldAndTwoOfSixAlone) {
  EXPECT_EQ(apart({{0, 0}, {100, 0}, {6'000'000, 0}, {-2'000'000, 5'000'000}}), (Rows{0, 1, 2, 3}));
  EXPECT_EQ(far({{0, 0}, {100, 0}, {0, 100}, {100, 100}, {6'000'000, 0}, {-2'000'000, 5'000'000}}),
            (Rows{4, 5}));
}

TEST(FarNodes, AChainOfAnyLengthIsOnePlace) {
  std::vector<Position> chain;
  for (std::int32_t at = 0; at < 12; ++at) chain.push_back({at * 900'000, at * 900'000});
  EXPECT_EQ(apart(chain), Rows{});
  EXPECT_EQ(far(chain), Rows{});
}

TEST(FarNodes, WithoutMetresNobodyKnowsWhatIsFar) {
  EXPECT_EQ(far_from(FarFrom::another, {{0, 0}, {6'000'000, 0}}, on({.unit_length = site_nano})),
            Rows{});
}

TEST(FarNodes, WhatWasSurveyedSaysWhichOfTwoIsWrong) {
  Settings settings = on(metres);
  settings.nodes.push_back({.bus = "yard", .position = Position{100, 100}});
  EXPECT_EQ(off_site({{100, 100}, {150'000, 0}}, settings), Rows{});
  EXPECT_EQ(off_site({{100, 100}, {6'000'000, 0}}, settings), Rows{1});
  EXPECT_EQ(off_site({{100, 100}, {6'000'000, 0}, {6'000'100, 0}, {6'000'000, 100}}, settings),
            (Rows{1, 2, 3}))
      << "most have the same mistake";
  EXPECT_EQ(off_site({{6'000'000, 0}}, settings), Rows{0}) << "its unit need not answer";
}

TEST(FarNodes, FixedPointsAndTheOriginAreOfTheSiteToo) {
  Settings settings = on(metres);
  settings.site.origin = {.x = 1, .y = 0};
  EXPECT_EQ(off_site({{150'000, 0}, {250'000, 0}}, settings), Rows{1});
  settings.anchors = {{.position = {400'000, 0}, .source = ""}};
  EXPECT_EQ(off_site({{150'000, 0}, {250'000, 0}, {601'000, 0}}, settings), Rows{2});
  settings = on(metres);
  settings.domain = SiteDomain({{.from = to_point({0, 0}), .to = to_point({900'000, 0})},
                                {.from = to_point({900'000, 0}), .to = to_point({0, 9})},
                                {.from = to_point({0, 9}), .to = to_point({0, 0})}},
                               {});
  EXPECT_EQ(off_site({{1'050'000, 0}, {0, 300'000}}, settings), Rows{1});
}

TEST(FarNodes, OneSurveyedElsewhereIsFarFromTheRestOfTheSite) {
  Settings settings = on(metres);
  for (const Position place : {Position{0, 0}, Position{100, 0}, Position{6'000'000, 0}}) {
    settings.nodes.push_back({.bus = "yard", .position = place});
  }
  EXPECT_EQ(off_site({{0, 0}, {100, 0}, {6'000'000, 0}}, settings), Rows{2});
  settings.nodes.erase(settings.nodes.begin());
  EXPECT_EQ(far_from(FarFrom::another, {{100, 0}, {6'000'000, 0}}, settings), (Rows{0, 1}))
      << "of two nobody can say";
  settings.site.origin = {.x = 1, .y = 0};
  EXPECT_EQ(off_site({{100, 0}, {6'000'000, 0}}, settings), Rows{1}) << "but by the origin";
}

TEST(FarNodes, UnitsAreTakenForWhatTheyAre) {
  SitePlane plane{.unit_length = 10'000'000, .metres = 1'000'000'000};
  EXPECT_EQ(far(yard_and({900'000, 0}), plane), Rows{}) << "9 km, in centimetres";
  EXPECT_EQ(far(yard_and({2'100'000, 0}), plane), Rows{5});
  plane = {.unit_length = 1'000'000'000};
  EXPECT_EQ(far(yard_and({20'500, 0}), plane), Rows{5}) << "a plane without metres";
  plane.unit_length = 1;
  EXPECT_EQ(far(yard_and({16'000'000, 0}), plane), Rows{});
}

TEST(FarNodes, AtTheEdgesOfThePlane) {
  EXPECT_EQ(far({{-position_max, -position_max},
                 {-position_max, -position_max},
                 {-position_max, -position_max},
                 {position_max, position_max}}),
            Rows{3});
}

TEST(FarNodes, AnchorsAndSteinerVerticesDoNotCount) {
  Snapshot snapshot;
  for (const Position place : yard_and({900'000, 0})) {
    SnapshotVertex& vertex = snapshot.vertices.emplace_back();
    vertex.kind = VertexKind::node;
    vertex.point = to_point(place);
  }
  snapshot.vertices[5].is_anchor = true;
  snapshot.vertices.push_back({.kind = VertexKind::steiner, .point = to_point({800'000, 0})});
  FarNodes nodes(10);
  nodes.set_site(on(metres));
  nodes.mark(snapshot);
  EXPECT_EQ(snapshot.far_count, 0u);
}

}  // namespace
}  // namespace etcm::firmware
