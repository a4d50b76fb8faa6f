// Anchors, features and the domain in a running gateway, and how they change while it runs.
#include <gtest/gtest.h>

#include "etcm/audit.h"
#include "etcm/config.h"
#include "fakes.h"
#include "firmware/mesh/node_placement.h"
#include "geojson.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

TEST(SiteKeeping, AnchorsAndTheirFeaturesAreThereBeforeAnyNode) {
  Rig rig;
  draw(rig.settings, {line(at(0, 0), at(100, 0)), line(at(100, 0), Serial{1001}, "mast line")});
  rig.run(200ms);
  EXPECT_EQ(rig.server.header("node_count"), 0u);
  EXPECT_EQ(rig.server.header("features_active"), 1u);
  EXPECT_EQ(rig.server.header("triangle_count"), 0u);
  rig.put(1, 50, 80);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("node_count"), 1u);
  EXPECT_EQ(rig.server.header("features_active"), 2u);
  EXPECT_EQ(rig.server.header("state"), 0u);
  EXPECT_EQ(rig.gateway->node_count(), 1u);
  EXPECT_TRUE(audit(rig.mesh));
}

// A wall with a corner at (100, 0); a cable from node 2 to node 1.
void draw_wall(Rig& rig) {
  draw(rig.settings, {line(at(0, 0), at(100, 0)), line(at(100, 0), at(100, 90)),
                      line(Serial{1002}, Serial{1001})});
  rig.put(2, 10, 60);
}

TEST(SiteKeeping, ANodeOnAnAnchorTakesItsPlaceUntilItLeaves) {
  Rig rig;
  draw_wall(rig);
  rig.run(500ms);
  const std::uint64_t before = rig.mesh.hash();
  rig.put(1, 100, 0);
  rig.run(500ms);
  EXPECT_EQ(rig.log.count("node 1001 joined at (100, 0), on the anchor"), 1u);
  EXPECT_EQ(rig.server.header("quarantined_count"), 0u);
  EXPECT_EQ(rig.server.header("node_count"), 2u);
  EXPECT_EQ(rig.server.header("anchor_count"), 2u);
  EXPECT_EQ(rig.server.header("features_active"), 3u) << "those of the wall and that of the node";
  EXPECT_EQ(rig.mesh.node_count(), 4u);
  EXPECT_EQ(rig.server.header("state"), 0u);
  EXPECT_TRUE(audit(rig.mesh));
  rig.bus.silence(1);
  rig.run(4s);
  EXPECT_EQ(rig.log.count("node 1001 left"), 1u);
  EXPECT_EQ(rig.server.header("node_count"), 1u);
  EXPECT_EQ(rig.server.header("anchor_count"), 3u);
  EXPECT_EQ(rig.server.header("features_active"), 2u);
  EXPECT_EQ(rig.mesh.hash(), before);
}

TEST(SiteKeeping, ANodeStepsOffAnAnchorAndOntoAnother) {
  Rig rig;
  draw_wall(rig);
  rig.put(1, 50, 50);
  rig.run(500ms);
  const auto expect = [&](std::uint32_t anchors, std::uint32_t in_mesh, const char* where) {
    EXPECT_EQ(rig.server.header("node_count"), 2u) << where;
    EXPECT_EQ(rig.server.header("anchor_count"), anchors) << where;
    EXPECT_EQ(rig.server.header("features_active"), 3u) << where;
    EXPECT_EQ(rig.server.header("quarantined_count"), 0u) << where;
    EXPECT_EQ(rig.mesh.node_count(), in_mesh) << where;
    EXPECT_TRUE(audit(rig.mesh)) << where;
  };
  expect(3, 5, "beside");
  const std::uint64_t beside = rig.mesh.hash();
  rig.put(1, 100, 0);
  rig.run(500ms);
  expect(2, 4, "on one");
  rig.put(1, 0, 0);
  rig.run(500ms);
  expect(2, 4, "on another");
  rig.put(1, 50, 50);
  rig.run(500ms);
  expect(3, 5, "beside again");
  EXPECT_EQ(rig.mesh.hash(), beside);
}

TEST(SiteKeeping, OfTwoNodesOnAnAnchorTheOneWithTheGreaterSerialWaits) {
  Rig rig;
  draw_wall(rig);
  rig.put(1, 100, 0);
  rig.run(500ms);
  rig.put(3, 100, 0);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("quarantined_count"), 1u);
  EXPECT_EQ(rig.log.count("node 1003 cannot join at (100, 0)"), 1u);
  EXPECT_EQ(rig.log.count("[node 1001]"), 1u);
  rig.put(1, 60, 60);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("quarantined_count"), 0u);
  EXPECT_EQ(rig.server.header("node_count"), 3u);
  EXPECT_EQ(rig.server.header("anchor_count"), 2u);
  // And back, where the other one is now.
  rig.put(1, 100, 0);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("quarantined_count"), 1u);
  EXPECT_EQ(rig.log.count("node 1003 left (node 1001, with a smaller serial, stands there too)"),
            1u);
  EXPECT_EQ(rig.log.count("node 1003 cannot join at (100, 0)"), 2u);
  EXPECT_EQ(rig.server.header("features_active"), 3u);
  EXPECT_TRUE(audit(rig.mesh));
}

TEST(SiteKeeping, ANodeThatStepsOffAnAnchorOntoAnotherNodeIsOut) {
  Rig rig;
  draw_wall(rig);
  rig.put(3, 100, 0);
  rig.run(500ms);
  const std::uint64_t before = rig.mesh.hash();
  EXPECT_EQ(rig.server.header("node_count"), 2u);
  rig.put(3, 10, 60);  // where node 2 is
  rig.run(500ms);
  EXPECT_EQ(rig.log.count("node 1003 cannot move at (10, 60)"), 1u);
  EXPECT_EQ(rig.log.count("node 1003 left (it is elsewhere)"), 1u);
  EXPECT_EQ(rig.server.header("quarantined_count"), 1u);
  EXPECT_EQ(rig.server.header("node_count"), 1u);
  EXPECT_EQ(rig.server.header("anchor_count"), 3u);
  EXPECT_EQ(rig.mesh.hash(), before) << "the anchor is there again";
  rig.put(3, 100, 0);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("quarantined_count"), 0u);
  EXPECT_EQ(rig.mesh.hash(), before);
}

// Of nodes that are not at an anchor.
TEST(SiteKeeping, TheSmallestSerialOfAPlaceIsInTheMesh) {
  Rig rig({feature(1001, 1004), feature(1002, 1004), feature(1003, 1004)});
  rig.put(4, 100, 0);
  rig.put(3, 0, 0);
  rig.run(500ms);
  rig.put(2, 0, 0);
  rig.run(500ms);
  EXPECT_EQ(rig.log.count("node 1003 left (node 1002, with a smaller serial, stands there too)"),
            1u);
  EXPECT_EQ(rig.log.count("node 1003 cannot join at (0, 0)"), 1u);
  EXPECT_EQ(rig.log.count("[node 1002]"), 1u);
  EXPECT_EQ(rig.server.header("node_count"), 2u);
  EXPECT_EQ(rig.server.header("features_active"), 1u);
  rig.put(1, 50, 50);
  rig.run(500ms);
  rig.put(1, 0, 0);
  rig.run(500ms);
  EXPECT_EQ(rig.log.count("node 1002 left (node 1001, with a smaller serial, stands there too)"),
            1u);
  EXPECT_EQ(rig.server.header("quarantined_count"), 2u);
  // When it is gone the next one is there, not the last one.
  rig.put(1, 50, 50);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("quarantined_count"), 1u);
  EXPECT_EQ(rig.gateway->quarantine()[0].serial, Serial{1003});
  EXPECT_EQ(rig.server.header("features_active"), 2u);
  EXPECT_TRUE(audit(rig.mesh));
}

TEST(SiteKeeping, ANodeKeepsItsPlaceWhenTheAnchorIsTakenOffTheDrawing) {
  Rig rig;
  draw_wall(rig);
  rig.put(1, 100, 0);
  rig.run(500ms);
  draw(rig.settings, {line(Serial{1002}, Serial{1001})});
  rig.update_settings();
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("node_count"), 2u);
  EXPECT_EQ(rig.server.header("anchor_count"), 0u);
  EXPECT_EQ(rig.server.header("features_active"), 1u);
  EXPECT_EQ(rig.mesh.node_count(), 2u);
  // And drawn again.
  draw_wall(rig);
  rig.update_settings();
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("anchor_count"), 2u);
  EXPECT_EQ(rig.server.header("features_active"), 3u);
  EXPECT_EQ(rig.mesh.node_count(), 4u);
  rig.bus.silence(1);
  rig.run(4s);
  EXPECT_EQ(rig.server.header("node_count"), 1u);
  EXPECT_EQ(rig.server.header("anchor_count"), 3u);
  EXPECT_EQ(rig.server.header("state"), 0u + (snapshot_state::partial | snapshot_state::missing))
      << "the cable waits";
  EXPECT_TRUE(audit(rig.mesh));
}

TEST(SiteKeeping, AnAnchorKeepsItsNodeOverAReloadOfTheSameSite) {
  Rig rig;
  draw_wall(rig);
  rig.put(1, 100, 0);
  rig.run(500ms);
  const std::uint64_t before = rig.mesh.hash();
  rig.update_settings();
  rig.run(500ms);
  EXPECT_EQ(rig.mesh.hash(), before);
  EXPECT_EQ(rig.server.header("node_count"), 2u);
  EXPECT_EQ(rig.server.header("anchor_count"), 2u);
  EXPECT_EQ(rig.server.header("features_active"), 3u);
}

TEST(SiteKeeping, ANodeThatIsPutOutOfTheDomainLeavesTheAnchorBehind) {
  Rig rig;
  draw_wall(rig);
  rig.put(1, 100, 0);
  rig.run(500ms);
  rig.settings.domain = square(0, 80);
  rig.update_settings();
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("node_count"), 1u);
  EXPECT_EQ(rig.server.header("anchor_count"), 3u);
  EXPECT_EQ(rig.server.header("features_active"), 2u);
  EXPECT_TRUE(audit(rig.mesh));
}

TEST(SiteKeeping, ANodeOutsideTheDomainIsNotInTheMesh) {
  Rig rig;
  rig.settings.domain = square(0, 100);
  rig.put(1, 100, 100);
  rig.put(2, 101, 100);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("node_count"), 1u);
  EXPECT_EQ(rig.server.header("quarantined_count"), 1u);
  EXPECT_EQ(rig.log.count("node 1002 cannot join at (101, 100): It stands outside the domain"), 1u);
  // One that goes astray is no longer where it was.
  rig.put(1, -1, 50);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("node_count"), 0u);
  EXPECT_EQ(rig.server.header("quarantined_count"), 2u);
  EXPECT_EQ(rig.log.count("node 1001 cannot move at (-1, 50)"), 1u);
  EXPECT_EQ(rig.log.count("node 1001 left (it is elsewhere)"), 1u);
  rig.put(1, 5, 50);
  rig.put(2, 6, 60);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("node_count"), 2u);
  EXPECT_EQ(rig.server.header("quarantined_count"), 0u);
}

TEST(SiteKeeping, ANodeThatWentAstrayStillLeaves) {
  Rig rig;
  rig.settings.domain = square(0, 100);
  rig.put(1, 10, 10);
  rig.put(2, 90, 90);
  rig.run(500ms);
  rig.put(1, 200, 10);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("quarantined_count"), 1u);
  rig.bus.silence(1);
  rig.run(4s);
  EXPECT_EQ(rig.server.header("node_count"), 1u);
  EXPECT_EQ(rig.server.header("quarantined_count"), 0u);
}

TEST(SiteKeeping, AnotherSiteIsTakenOverWhileItRuns) {
  Rig rig;
  draw(rig.settings, {line(at(0, 0), at(100, 0)), line(at(100, 0), at(100, 100)),
                      line(Serial{1001}, Serial{1002})});
  for (std::uint8_t unit = 1; unit <= 4; ++unit) rig.put(unit, 20 * unit, 30 + 7 * unit * unit);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("features_active"), 3u);
  const std::uint32_t before = rig.gateway->generation();

  // One stays (drawn the other way round), two go, two come; one anchor goes, one comes.
  draw(rig.settings, {line(Serial{1003}, Serial{1004}), line(at(100, 0), at(0, 0)),
                      line(at(0, 0), at(-50, 70)), line(Serial{1002}, Serial{9})});
  rig.update_settings();
  rig.run(500ms);
  EXPECT_GT(rig.gateway->generation(), before);
  EXPECT_EQ(rig.server.header("features_configured"), 4u);
  EXPECT_EQ(rig.server.header("features_active"), 3u) << "node 9 is not there";
  EXPECT_EQ(rig.server.header("node_count"), 4u);
  EXPECT_EQ(rig.mesh.node_count(), 7u) << "four nodes and three anchors";
  EXPECT_TRUE(audit(rig.mesh));
}

TEST(SiteKeeping, TheMeshIsTheOneOfTheNewSiteAlone) {
  Rig rig;
  Rig fresh;
  const std::vector<FeatureSettings> features = {line(at(0, 0), at(90, 10)),
                                                 line(Serial{1001}, at(90, 10))};
  draw(rig.settings, {line(at(5, 5), at(60, 60)), line(Serial{1001}, Serial{1002}),
                      line(at(60, 60), Serial{1003})});
  draw(fresh.settings, features);
  for (Rig* one : {&rig, &fresh}) {
    for (std::uint8_t unit = 1; unit <= 4; ++unit) one->put(unit, 21 * unit, 40 + 5 * unit * unit);
    one->run(500ms);
  }
  draw(rig.settings, features);
  rig.update_settings();
  rig.run(500ms);
  EXPECT_EQ(rig.mesh.hash(), fresh.mesh.hash());
}

TEST(SiteKeeping, ASmallerDomainPutsNodesOutAndALargerOneBackIn) {
  Rig rig;
  rig.put(1, 10, 10);
  rig.put(2, 500, 10);
  rig.settings.features = {line(Serial{1001}, Serial{1002})};
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("features_active"), 1u);
  rig.settings.domain = square(0, 100);
  rig.update_settings();
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("node_count"), 1u);
  EXPECT_EQ(rig.server.header("features_active"), 0u);
  EXPECT_EQ(rig.server.header("quarantined_count"), 1u);
  EXPECT_EQ(rig.log.count("node 1002 left (the domain has changed)"), 1u);
  rig.settings.domain = {};
  rig.update_settings();
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("node_count"), 2u);
  EXPECT_EQ(rig.server.header("features_active"), 1u);
  EXPECT_EQ(rig.server.header("state"), 0u);
}

TEST(SiteKeeping, AnAnchorThatComesWhereANodeStandsSharesItsPlace) {
  Rig rig;
  rig.put(1, 10, 10);
  rig.run(500ms);
  draw(rig.settings, {line(at(10, 10), at(50, 50))});
  rig.update_settings();
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("features_active"), 1u);
  EXPECT_EQ(rig.server.header("quarantined_count"), 0u);
  EXPECT_EQ(rig.server.header("node_count"), 1u);
  EXPECT_EQ(rig.server.header("anchor_count"), 1u);
  EXPECT_EQ(rig.mesh.node_count(), 2u);
  rig.put(1, 12, 10);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("features_active"), 1u);
  EXPECT_EQ(rig.server.header("anchor_count"), 2u);
  EXPECT_EQ(rig.mesh.node_count(), 3u);
}

TEST(SiteKeeping, WithoutTheAnchorWhereTheyCrossTheLaterFeatureGivesWay) {
  Rig rig;
  // The two lines between nodes cross at the anchor, and only there may they.
  rig.settings.anchors = {{.position = {50, 50}, .source = "site.geojson:1"}};
  rig.settings.features = {line(Serial{1001}, Serial{1003}), line(Serial{1002}, Serial{1004})};
  rig.put_square();
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("features_active"), 2u);
  rig.settings.anchors.clear();
  rig.update_settings();
  rig.run(500ms);
  EXPECT_EQ(rig.mesh.node_count(), 4u);
  EXPECT_EQ(rig.log.count("feature 2 (1002-1004, site.geojson:1) refused"), 1u);
  EXPECT_EQ(
      rig.log.count("refused: it crosses feature 1 (1001-1003, site.geojson:1) at (50, 50); in the "
                    "site file give both lines a vertex there"),
      1u);
  rig.put(5, 50, 50);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("features_active"), 2u) << "a node does as well";
  EXPECT_TRUE(audit(rig.mesh));
}

TEST(SiteKeeping, AnEarlierFeatureThatComesLaterPutsTheLaterOneOut) {
  Rig rig({feature(1001, 1003), feature(1002, 1004)});
  rig.put(2, 100, 0);
  rig.put(3, 100, 100);
  rig.put(4, 0, 100);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("features_active"), 1u);
  EXPECT_EQ(rig.server.header("quarantined_count"), 0u);
  rig.put(1, 0, 0);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("features_active"), 1u);
  EXPECT_EQ(rig.log.count("feature 2 (1002-1004, site.toml:1) refused"), 1u);
  EXPECT_EQ(
      rig.log.count("refused: it crosses feature 1 (1001-1003, site.toml:1) at (50, 50); let it "
                    "run over node 1003, where feature 1 ends, as two [[feature]]"),
      1u);
  // As soon as that one goes.
  rig.bus.silence(3);
  rig.run(4s);
  EXPECT_EQ(rig.server.header("features_active"), 1u);
  EXPECT_EQ(rig.server.header("quarantined_count"), 0u);
  EXPECT_TRUE(audit(rig.mesh));
}

TEST(SiteKeeping, ANodeMovesAcrossAFeatureAndTheLaterOneWaits) {
  Rig rig({feature(1001, 1002), feature(1003, 1004)});
  rig.put(1, 0, 0);
  rig.put(2, 100, 0);
  rig.put(3, 50, 50);
  rig.put(4, 80, 90);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("features_active"), 2u);
  rig.put(4, 50, -50);
  rig.run(500ms);
  EXPECT_EQ(rig.log.count("node 1004 moved from (80, 90) to (50, -50)"), 1u);
  EXPECT_EQ(rig.log.count("feature 2 (1003-1004, site.toml:1) refused"), 1u);
  EXPECT_EQ(rig.server.header("features_active"), 1u);
  EXPECT_EQ(rig.server.header("quarantined_count"), 1u);
  rig.put(4, 80, 90);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("features_active"), 2u);
  // It is the later one of the two, whoever moves.
  rig.put(2, 100, 106);
  rig.run(500ms);
  EXPECT_EQ(rig.log.count("node 1002 moved"), 1u);
  EXPECT_EQ(rig.log.count("feature 2 (1003-1004, site.toml:1) refused"), 2u);
  EXPECT_TRUE(audit(rig.mesh));
}

// A fence from node `first` to the one after it, and in its middle a node, with a post on either
// side: without that node the fence would need a Steiner vertex. A cable leads from it to a post.
void put_fence(Rig& rig, std::uint8_t first, std::int32_t x) {
  const Position places[] = {{0, 0}, {100, 0}, {50, 10}, {50, -10}, {50, 0}};
  for (const Position& place : places) {
    rig.put(static_cast<std::uint8_t>(first + (&place - places)), x + place.x, place.y);
  }
  const std::uint32_t serial = 1000u + first;
  rig.settings.features.push_back(feature(serial, serial + 1));
  rig.settings.features.push_back(feature(serial + 4, serial + 2));
}

TEST(SiteKeeping, ANodeThatCouldNotLeaveHasItsFeaturesBack) {
  for (const std::int32_t moves : {0, 5}) {
    Rig rig({}, 5);
    put_fence(rig, 1, 0);
    rig.run(500ms);
    ASSERT_EQ(rig.server.header("features_active"), 2u);
    rig.bus.silence(5);
    rig.run(4s);
    ASSERT_EQ(rig.log.count("node 1005 cannot leave"), 1u);
    ASSERT_EQ(rig.server.header("features_active"), 1u);
    ASSERT_EQ(rig.server.header("quarantined_count"), 1u);
    rig.put(5, 50, 0);
    rig.run(1s);
    EXPECT_EQ(rig.server.header("features_active"), 2u);
    EXPECT_EQ(rig.server.header("quarantined_count"), 0u);
    EXPECT_EQ(rig.server.header("state"), 0u);
    EXPECT_TRUE(audit(rig.mesh));
    // The same once more.
    rig.bus.silence(5);
    rig.run(4s);
    EXPECT_EQ(rig.log.count("node 1005 cannot leave"), 2u);
    EXPECT_EQ(rig.server.header("features_active"), 1u);
    // Without a fix it is there too; and where it is somewhere else, that is rejected for itself.
    rig.put(5, 50, moves, moves == 0 ? std::uint16_t{0} : node_status::fix_valid);
    rig.run(1s);
    EXPECT_EQ(rig.server.header("features_active"), 2u) << moves;
    EXPECT_EQ(rig.log.count("node 1005 cannot move"), moves == 0 ? 0u : 1u);
  }
}

// All or nothing: it stays where it was, with its features, rather than nowhere.
TEST(SiteKeeping, ANodeThatStraysAndCannotLeaveStaysWithItsFeatures) {
  Rig rig({}, 5);
  put_fence(rig, 1, 0);
  rig.run(500ms);
  const std::uint64_t before = rig.mesh.hash();
  rig.put(5, 0, 0);  // where node 1 is
  rig.run(1s);
  EXPECT_EQ(rig.log.count("node 1005 cannot move at (0, 0)"), 1u);
  EXPECT_EQ(rig.mesh.hash(), before);
  EXPECT_EQ(rig.server.header("features_active"), 2u);
  EXPECT_EQ(rig.server.header("quarantined_count"), 1u);
  rig.bus.silence(3);
  rig.run(5s);
  EXPECT_EQ(rig.log.count("node 1005 left"), 1u) << "there is room now";
  EXPECT_EQ(rig.server.header("quarantined_count"), 1u);
  EXPECT_EQ(rig.server.header("node_count"), 3u);
  EXPECT_TRUE(audit(rig.mesh));
}

TEST(SiteKeeping, NodesThatCannotLeaveMakeNoGenerations) {
  Rig rig({}, 10);
  put_fence(rig, 1, 0);
  put_fence(rig, 11, 1000);
  rig.run(500ms);
  ASSERT_EQ(rig.server.header("features_active"), 4u);
  rig.bus.silence(5);
  rig.bus.silence(15);
  rig.run(4s);
  ASSERT_EQ(rig.log.count("cannot leave"), 2u);
  const std::uint32_t generation = rig.gateway->generation();
  const std::uint64_t changes = rig.gateway->mesh_times().changes;
  rig.run(10s);
  EXPECT_EQ(rig.gateway->generation(), generation);
  EXPECT_EQ(rig.gateway->mesh_times().changes, changes) << "nothing to try again for";
  // Room for one of them, whose place then is room for the other.
  rig.bus.silence(3);
  rig.run(4s);
  EXPECT_EQ(rig.log.count("node 1005 left") + rig.log.count("node 1015 left"), 2u);
  EXPECT_TRUE(audit(rig.mesh));
}

// On which everything takes a millisecond.
class BusyClock final : public port::Clock {
 public:
  port::Instant now() const override { return now_ += 1ms; }
  void pass(port::Duration time) { now_ += time; }

 private:
  mutable port::Instant now_{std::chrono::hours(1)};
};

// Many features that there is no room for, and a node that moves all the time.
TEST(SiteKeeping, FeaturesThatWaitForRoomAreNotTriedAtEachMove) {
  constexpr std::uint32_t rejected_count = 10;
  Settings settings;
  settings.mesh = {.vertices_max = 100, .features_max = 2};
  settings.features = {feature(1, 2), feature(2, 3)};
  for (std::uint32_t i = 0; i < rejected_count; ++i) {
    settings.features.push_back(feature(100 + i, 200 + i));
  }
  std::vector<std::byte> memory(storage_bytes(settings.mesh));
  Mesh mesh;
  ASSERT_EQ(mesh.open(memory, settings.mesh), Status::ok);
  BusyClock clock;
  RecordingLog log;
  NodeTable nodes(100, 100);
  KeptMesh kept(mesh, settings);
  SiteKeeper site(kept, nodes, clock, log);
  NodePlacement placement(kept, site, nodes, settings, clock, log);
  const auto join = [&](std::uint32_t serial, std::int32_t x, std::int32_t y) {
    NodeRecord* const node = nodes.add(Serial{serial}, clock.now());
    node->position = {x, y};
    placement.join(*node, 1);
    return node;
  };
  join(1, 0, -300);
  NodeRecord* const hub = join(2, 1000, -300);
  join(3, 2000, -300);
  for (std::uint32_t i = 0; i < rejected_count; ++i) {
    join(100 + i, 50 + 70 * static_cast<std::int32_t>(i), 90);
    join(200 + i, 50 + 70 * static_cast<std::int32_t>(i), -90);
  }
  NodeRecord* const rover = join(4, 0, 500);
  const FeatureRecord& rejected = kept.features().records()[2];
  ASSERT_EQ(kept.features().rejected_count(), rejected_count);

  const port::Instant begin = clock.now();
  std::uint32_t tries = 0;
  for (std::int32_t move = 1; move <= 500; ++move) {
    rover->position = {move, 500};
    placement.move(*rover, 1);
    const std::uint32_t before = rejected.rejected_epoch;
    placement.settle(1);
    EXPECT_EQ(rejected.rejected_epoch, before) << "that is not for want of room";
    placement.retry_rejected(1);
    tries += rejected.rejected_epoch != before;
    clock.pass(5ms);
  }
  const auto tries_max =
      static_cast<std::uint32_t>((clock.now() - begin) / (retry_share * rejected_count * 1ms)) + 1;
  EXPECT_LE(tries, tries_max);
  EXPECT_GE(tries * 2, tries_max);

  // Two of them have room then.
  placement.leave(*hub, "silent", 1);
  ASSERT_LE(placement.next_deadline(), clock.now() + 1s);
  clock.pass(placement.next_deadline() - clock.now());
  placement.retry_rejected(1);
  EXPECT_EQ(kept.features().active_count(), 2u);
  EXPECT_EQ(placement.next_deadline(), port::never);
}

// Refused features are looked at where something has come or gone that matters to them.
TEST(SiteKeeping, RefusedFeaturesAreLeftAloneWhereNothingOfTheirsHasChanged) {
  Rig rig({feature(1001, 1003), feature(1002, 1004)});
  rig.put_square();
  rig.put(9, 300, 300);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("quarantined_count"), 1u);
  rig.put(9, 300, 400);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("quarantined_count"), 1u);
  EXPECT_EQ(rig.log.count("refused"), 1u);
  rig.put(9, 50, 50);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("quarantined_count"), 0u) << "they may cross in a node";
  rig.put(9, 50, 51);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("quarantined_count"), 1u);
  EXPECT_EQ(rig.log.count("refused"), 2u);
  EXPECT_TRUE(audit(rig.mesh));
}

}  // namespace
}  // namespace etcm::firmware
