// Which nodes stand far from all others.
#include "firmware/publish/far_nodes.h"

#include <gtest/gtest.h>

#include <vector>

namespace etcm::firmware {
namespace {

const SitePlane metres{.unit_length = 1'000'000'000, .metres = 1'000'000'000};

// Rows of those that are far.
std::vector<std::size_t> far(const std::vector<Position>& places, SitePlane plane = metres) {
  Snapshot snapshot;
  for (const Position place : places) {
    SnapshotVertex& vertex = snapshot.vertices.emplace_back();
    vertex.kind = VertexKind::node;
    vertex.point = to_point(place);
  }
  FarNodes nodes(static_cast<std::uint32_t>(places.size()));
  nodes.set_plane(plane);
  nodes.mark(snapshot);
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < snapshot.vertices.size(); ++row) {
    if (snapshot.vertices[row].is_far) rows.push_back(row);
  }
  EXPECT_EQ(snapshot.far_count, rows.size());
  return rows;
}

using Rows = std::vector<std::size_t>;

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
  nodes.set_plane(metres);
  nodes.mark(snapshot);
  EXPECT_EQ(snapshot.far_count, 0u);
}

}  // namespace
}  // namespace etcm::firmware
