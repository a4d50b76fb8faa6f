// What a generation tells an operator, from the settings to the registers.
#include "firmware/publish/analyst.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "fakes.h"
#include "firmware/gateway/gateway.h"
#include "firmware/publish/mesh_registers.h"
#include "geojson.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

// Of the square.
std::vector<FeatureSettings> sides() {
  return {feature(1001, 1002), feature(1002, 1003), feature(1003, 1004), feature(1004, 1001)};
}

TEST(Analyst, SaysNothingUnasked) {
  Rig rig(sides());
  rig.put_square();
  rig.run(1s);
  for (const char* name : {"radio_range", "least_range_alone", "parts_alone", "relay_count",
                           "sensing_range", "hole_count", "gap_count"}) {
    EXPECT_EQ(rig.server.header(name), 0u) << name;
  }
}

TEST(Analyst, TellsWhatRadiosNeed) {
  Rig rig(sides());
  rig.settings.analysis.radio_range = 40;
  rig.put_square();
  rig.run(1s);
  EXPECT_EQ(rig.server.header("radio_range"), 40u);
  EXPECT_EQ(rig.server.header("least_range_alone"), 100u);
  EXPECT_EQ(rig.server.header("parts_alone"), 4u);
  EXPECT_EQ(rig.server.header("long_link_count"), 5u);
  // Two on each side.
  EXPECT_EQ(rig.server.header("relay_count"), 8u);
  const Snapshot& snapshot = rig.gateway->snapshot();
  ASSERT_EQ(snapshot.analysis.relays.size(), 8u);
  EXPECT_EQ(snapshot.analysis.relays[0].row, no_row);
  EXPECT_GE(snapshot.analysis.relays[0].feature, 1u);
  EXPECT_LE(snapshot.analysis.relays[0].feature, 4u);
  // The diagonal is in neither subgraph.
  for (const SnapshotNeighbour& neighbour : snapshot.neighbours) {
    EXPECT_EQ(neighbour.gabriel, neighbour.constrained);
    EXPECT_EQ(neighbour.urquhart, neighbour.constrained);
  }
  EXPECT_EQ(rig.server.header("sensing_range"), 0u);
}

TEST(Analyst, FollowsTheMesh) {
  Rig rig(sides());
  rig.settings.analysis.sensing_range = 50;
  rig.put_square();
  rig.run(1s);
  // The middle is 71 from all corners; the sides are just seen.
  EXPECT_EQ(rig.server.header("hole_count"), 1u);
  EXPECT_EQ(rig.server.header("gap_count"), 0u);
  const MeshAnalysis& analysis = rig.gateway->snapshot().analysis;
  ASSERT_EQ(analysis.holes.size(), 1u);
  EXPECT_EQ(analysis.holes[0].point, to_point({50, 50}));
  EXPECT_EQ(analysis.holes[0].distance, 71u);
  EXPECT_FALSE(analysis.holes[0].on_boundary);
  rig.put(5, 50, 50);
  rig.run(1s);
  EXPECT_EQ(rig.server.header("hole_count"), 0u);
  EXPECT_TRUE(analysis.holes.empty());
}

// A Steiner vertex is proposed, not there: it neither senses nor forwards.
TEST(Analyst, LeavesSteinerVerticesOutOfTheNetworkAsItStands) {
  Rig rig({feature(1001, 1002)});
  rig.settings.analysis = {.radio_range = 950, .sensing_range = 400};
  rig.put(1, -1000, 0);
  rig.put(2, 1000, 0);
  rig.put(3, 0, 90);
  rig.put(4, 0, -90);
  rig.run(1s);
  ASSERT_GT(rig.mesh.steiner_count(), 0u);
  EXPECT_EQ(rig.server.header("least_range_alone"), 1005u);
  EXPECT_EQ(rig.server.header("parts_alone"), 3u);
  EXPECT_LT(rig.server.header("least_range_with_relays"), 1005u);
  EXPECT_EQ(rig.server.header("gap_count"), 1u);
  EXPECT_EQ(rig.server.header("unwatched_gap_count"), 1u);
  const MeshAnalysis& analysis = rig.gateway->snapshot().analysis;
  std::uint32_t at_steiner_vertices = 0;
  for (const ProposedRelay& relay : analysis.relays) {
    if (relay.row == no_row) continue;
    EXPECT_EQ(rig.gateway->snapshot().vertices[relay.row].kind, VertexKind::steiner);
    ++at_steiner_vertices;
  }
  EXPECT_EQ(at_steiner_vertices, rig.mesh.steiner_count());
}

// A fence of 100 by 100 is drawn, with a pond of 20 by 20 in it.
void draw_fence(Rig& rig) {
  draw(rig.settings, lines_along({ring(0, 100), ring(40, 60)}));
  rig.settings.domain = {ring(0, 100), ring(40, 60)};
}

TEST(Analyst, TakesAnAnchorForNoDevice) {
  Rig rig;
  draw_fence(rig);
  rig.settings.analysis = {.radio_range = 60, .sensing_range = 50};
  rig.put(1, 20, 50);
  rig.put(2, 80, 51);
  rig.run(1s);
  EXPECT_EQ(rig.server.header("node_count"), 2u);
  EXPECT_EQ(rig.server.header("anchor_count"), 8u);
  EXPECT_EQ(rig.server.header("least_range_alone"), 61u);
  EXPECT_EQ(rig.server.header("parts_alone"), 2u);
  EXPECT_EQ(rig.server.header("long_link_count"), 1u);
  const MeshAnalysis& analysis = rig.gateway->snapshot().analysis;
  ASSERT_EQ(analysis.long_links.size(), 1u);
  for (const std::uint32_t row : {analysis.long_links[0].from_row, analysis.long_links[0].to_row}) {
    EXPECT_FALSE(rig.gateway->snapshot().vertices[row].is_anchor);
  }
  // One at each corner, and one on each side of the fence: 100 is more than a hop.
  EXPECT_EQ(rig.server.header("relay_count"), 8u + rig.mesh.steiner_count() + 4u);
  for (std::uint32_t i = 0; i < 8; ++i) EXPECT_GE(analysis.relays[i].feature, 1u);
  // The corners of the fence, and where the two take turns on it.
  EXPECT_EQ(rig.server.header("hole_count"), 4u + 2u);
  EXPECT_EQ(rig.server.header("gap_count"), 8u);
  EXPECT_EQ(rig.server.header("unwatched_gap_count"), 4u);
}

TEST(Analyst, TakesTheHolesOutOfTheDomain) {
  Rig rig;
  draw_fence(rig);
  rig.settings.analysis.sensing_range = 12;
  for (std::uint8_t unit = 1; unit <= 4; ++unit) {
    rig.put(unit, unit % 2 == 0 ? 40 : 60, unit > 2 ? 40 : 60);
  }
  rig.run(1s);
  const auto lists_the_pond = [&] {
    const auto& holes = rig.gateway->snapshot().analysis.holes;
    return std::any_of(holes.begin(), holes.end(), [](const CoverageHole& hole) {
      return hole.point == to_point({50, 50});
    });
  };
  EXPECT_GT(rig.server.header("hole_count"), 0u);
  EXPECT_FALSE(lists_the_pond());
  // The pond is taken off the drawing.
  rig.settings.domain = square(0, 100);
  rig.update_settings();
  rig.run(1s);
  EXPECT_TRUE(lists_the_pond());
}

TEST(Analyst, KeepsTheDomainWhereACornerOfItIsANodeThatIsAway) {
  Rig rig;
  rig.settings.domain = square(0, 100);
  rig.settings.analysis.sensing_range = 72;
  draw(rig.settings, {line(Serial{1001}, at(100, 0)), line(at(100, 0), at(100, 100)),
                      line(at(100, 100), at(0, 100)), line(at(0, 100), Serial{1001})});
  rig.put(2, 50, 50);
  rig.run(1s);
  EXPECT_EQ(rig.server.header("features_active"), 2u);
  EXPECT_EQ(rig.server.header("hole_count"), 0u);
  rig.put(2, 51, 51);
  rig.run(1s);
  EXPECT_EQ(rig.server.header("hole_count"), 1u) << "the corner without a node";
  rig.put(1, 0, 0);
  rig.run(1s);
  EXPECT_EQ(rig.server.header("hole_count"), 0u);
}

// Without an outline: closed features are, or the hull is, and a hole counts once it is whole.
TEST(Analyst, TakesAHoleOutOfWhatFeaturesEncloseOnceItIsWhole) {
  Rig rig;
  std::vector<FeatureSettings> features = lines_along({ring(0, 100), ring(40, 60)});
  features.back().from = Serial{1005};
  features[6].to = Serial{1005};
  draw(rig.settings, features);
  rig.settings.domain = {{}, ring(40, 60)};
  rig.settings.analysis.sensing_range = 14;
  rig.put(1, 60, 60);
  rig.put(2, 60, 40);
  rig.put(3, 40, 39);
  rig.put(4, 39, 60);
  rig.run(1s);
  const auto in_the_pond = [&] {
    std::size_t count = 0;
    for (const CoverageHole& hole : rig.gateway->snapshot().analysis.holes) {
      const auto is_within = [](std::int64_t c) {
        return c > 40 * subunits_per_unit && c < 60 * subunits_per_unit;
      };
      if (is_within(hole.point.x) && is_within(hole.point.y)) ++count;
    }
    return count;
  };
  EXPECT_EQ(rig.server.header("features_active"), 6u);
  EXPECT_EQ(in_the_pond(), 1u);
  rig.put(5, 40, 60);
  rig.run(1s);
  EXPECT_EQ(rig.server.header("features_active"), 8u);
  EXPECT_EQ(in_the_pond(), 0u);
  EXPECT_GT(rig.server.header("hole_count"), 0u);
}

TEST(Analyst, WatchesTheEndOfAFeatureFromTheNodeOnIt) {
  Rig rig;
  draw(rig.settings, {line(Serial{1001}, at(100, 0)), line(at(100, 0), at(150, 0))});
  rig.settings.analysis.sensing_range = 99;
  rig.put(1, 0, 0);
  rig.run(1s);
  EXPECT_EQ(rig.server.header("gap_count"), 2u);
  EXPECT_EQ(rig.server.header("unwatched_gap_count"), 2u);
  rig.put(2, 125, 20);
  rig.run(1s);
  EXPECT_EQ(rig.server.header("gap_count"), 2u);
  EXPECT_EQ(rig.server.header("unwatched_gap_count"), 0u);
}

TEST(Analyst, CutsItsListsOffButCountsOn) {
  Rig rig({feature(1001, 1002)});
  rig.settings.analysis = {.radio_range = 1, .sensing_range = 1};
  rig.put(1, -position_max, 0);
  rig.put(2, position_max, 0);
  rig.run(1s);
  EXPECT_EQ(rig.server.header("relay_count"), 2u * position_max - 1u);
  const MeshAnalysis& analysis = rig.gateway->snapshot().analysis;
  EXPECT_EQ(analysis.relays.size(), analysis_list_max);
  EXPECT_EQ(analysis.relays.capacity(), analysis_list_max);
}

// All leave, on their own request or because a bus is unplugged, and come back: first one, then
// two, then all. A mesh of fewer than three has nothing between its nodes to ask for.
TEST(Analyst, OutlivesThatAllLeaveAndSomeComeBack) {
  Rig rig(sides());
  rig.settings.analysis = {.radio_range = 50, .sensing_range = 50};
  for (std::uint32_t back = 0; back <= 4; ++back) {
    rig.put_square();
    rig.run(1s);
    EXPECT_EQ(rig.server.header("hole_count"), 1u);
    for (std::uint8_t unit = 1; unit <= 4; ++unit) {
      rig.put(unit, 0, unit, node_status::leaving);
      rig.run(200ms);
    }
    rig.run(1s);
    EXPECT_EQ(rig.server.header("node_count"), 0u);
    EXPECT_EQ(rig.server.header("hole_count"), 0u);
    for (std::uint8_t unit = 1; unit <= back; ++unit) {
      rig.put(unit, 100 * unit, 7);
      rig.run(1s);
      EXPECT_EQ(rig.server.header("node_count"), unit);
      EXPECT_EQ(rig.server.header("parts_alone"), unit);
      EXPECT_EQ(rig.server.header("hole_count"), 0u);
    }
  }
}

TEST(Analyst, HasNothingToSayOfNoNodes) {
  Rig rig;
  rig.settings.analysis = {.radio_range = 5, .sensing_range = 5};
  rig.put(1, 0, 0);
  rig.run(1s);
  EXPECT_EQ(rig.server.header("parts_alone"), 1u);
  rig.put(1, 0, 0, node_status::leaving);
  rig.run(1s);
  EXPECT_EQ(rig.server.header("node_count"), 0u);
  EXPECT_EQ(rig.server.header("parts_alone"), 0u);
  EXPECT_EQ(rig.server.header("hole_count"), 0u);
}

}  // namespace
}  // namespace etcm::firmware
