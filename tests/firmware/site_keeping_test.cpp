// Anchors, features and the domain in a running gateway, and how they change while it runs.
#include <gtest/gtest.h>

#include "etcm/audit.h"
#include "fakes.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

FeatureEnd at(std::int32_t x, std::int32_t y) { return FeatureEnd::anchor({x, y}); }

FeatureSettings line(FeatureEnd from, FeatureEnd to, const std::string& name = "") {
  return {.from = from, .to = to, .name = name, .place = "site.geojson:1"};
}

// The settings get an anchor for each end that is none yet.
void draw(Settings& settings, std::vector<FeatureSettings> features) {
  settings.features = std::move(features);
  settings.anchors.clear();
  for (const FeatureSettings& feature : settings.features) {
    for (const FeatureEnd& end : {feature.from, feature.to}) {
      const bool is_known = std::any_of(
          settings.anchors.begin(), settings.anchors.end(),
          [&](const AnchorSettings& anchor) { return anchor.position == end.position; });
      if (end.is_anchor && !is_known) {
        settings.anchors.push_back({.position = end.position, .place = "site.geojson:1"});
      }
    }
  }
}

SiteDomain square(std::int32_t from, std::int32_t to) {
  const Point corner[4] = {to_point({from, from}), to_point({to, from}), to_point({to, to}),
                           to_point({from, to})};
  std::vector<DomainEdge> edges;
  for (int i = 0; i < 4; ++i) edges.push_back({.from = corner[i], .to = corner[(i + 1) % 4]});
  return {edges, {}};
}

TEST(SiteKeeping, AnchorsAndTheirFeaturesAreThereBeforeAnyNode) {
  Rig rig;
  draw(rig.settings, {line(at(0, 0), at(100, 0)), line(at(100, 0), 1001, "mast line")});
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

TEST(SiteKeeping, ANodeOnAnAnchorIsToldWhatToDo) {
  Rig rig;
  draw(rig.settings, {line(at(0, 0), at(100, 0))});
  rig.put(1, 100, 0);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("quarantined_count"), 1u);
  EXPECT_EQ(rig.log.count("node 1001 cannot join at (100, 0)"), 1u);
  EXPECT_EQ(
      rig.log.count("[the anchor at (100, 0) (site.geojson:1); give the serial of the node there"),
      1u);
  rig.put(1, 100, 1);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("quarantined_count"), 0u);
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
  // One that goes astray stays where it was last good.
  rig.put(1, -1, 50);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("node_count"), 1u);
  EXPECT_EQ(rig.server.header("quarantined_count"), 2u);
  EXPECT_EQ(rig.log.count("node 1001 cannot move at (-1, 50)"), 1u);
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
  rig.run(500ms);
  rig.put(1, 200, 10);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("quarantined_count"), 1u);
  rig.bus.silence(1);
  rig.run(4s);
  EXPECT_EQ(rig.server.header("node_count"), 0u);
  EXPECT_EQ(rig.server.header("quarantined_count"), 0u);
}

TEST(SiteKeeping, AnotherSiteIsTakenOverWhileItRuns) {
  Rig rig;
  draw(rig.settings,
       {line(at(0, 0), at(100, 0)), line(at(100, 0), at(100, 100)), line(1001, 1002)});
  for (std::uint8_t unit = 1; unit <= 4; ++unit) rig.put(unit, 20 * unit, 30 + 7 * unit * unit);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("features_active"), 3u);
  const std::uint32_t before = rig.gateway->generation();

  // One stays (drawn the other way round), two go, two come; one anchor goes, one comes.
  draw(rig.settings,
       {line(1003, 1004), line(at(100, 0), at(0, 0)), line(at(0, 0), at(-50, 70)), line(1002, 9)});
  rig.gateway->update_settings();
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
                                                 line(1001, at(90, 10))};
  draw(rig.settings, {line(at(5, 5), at(60, 60)), line(1001, 1002), line(at(60, 60), 1003)});
  draw(fresh.settings, features);
  for (Rig* one : {&rig, &fresh}) {
    for (std::uint8_t unit = 1; unit <= 4; ++unit) one->put(unit, 21 * unit, 40 + 5 * unit * unit);
    one->run(500ms);
  }
  draw(rig.settings, features);
  rig.gateway->update_settings();
  rig.run(500ms);
  EXPECT_EQ(rig.mesh.hash(), fresh.mesh.hash());
}

TEST(SiteKeeping, ASmallerDomainPutsNodesOutAndALargerOneBackIn) {
  Rig rig;
  rig.put(1, 10, 10);
  rig.put(2, 500, 10);
  rig.settings.features = {line(1001, 1002)};
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("features_active"), 1u);
  rig.settings.domain = square(0, 100);
  rig.gateway->update_settings();
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("node_count"), 1u);
  EXPECT_EQ(rig.server.header("features_active"), 0u);
  EXPECT_EQ(rig.server.header("quarantined_count"), 1u);
  EXPECT_EQ(rig.log.count("node 1002 left (the domain has changed)"), 1u);
  rig.settings.domain = {};
  rig.gateway->update_settings();
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("node_count"), 2u);
  EXPECT_EQ(rig.server.header("features_active"), 1u);
  EXPECT_EQ(rig.server.header("state"), 0u);
}

TEST(SiteKeeping, AnAnchorWhereANodeStandsWaitsForIt) {
  Rig rig;
  rig.put(1, 10, 10);
  rig.run(500ms);
  draw(rig.settings, {line(at(10, 10), at(50, 50))});
  rig.gateway->update_settings();
  rig.run(500ms);
  EXPECT_EQ(rig.log.count("the anchor at (10, 10) (site.geojson:1) is not in the mesh"), 1u);
  EXPECT_EQ(rig.server.header("features_active"), 0u);
  EXPECT_EQ(rig.server.header("quarantined_count"), 1u);
  rig.put(1, 12, 10);
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("features_active"), 1u);
  EXPECT_EQ(rig.server.header("quarantined_count"), 0u);
}

TEST(SiteKeeping, AnAnchorTheMeshCannotSpareGoesWhenItCan) {
  Rig rig;
  // The two lines between nodes cross at the anchor, and only there may they.
  rig.settings.anchors = {{.position = {50, 50}, .place = "site.geojson:1"}};
  rig.settings.features = {line(1001, 1003), line(1002, 1004)};
  rig.put_square();
  rig.run(500ms);
  EXPECT_EQ(rig.server.header("features_active"), 2u);
  rig.settings.anchors.clear();
  rig.gateway->update_settings();
  rig.run(500ms);
  EXPECT_EQ(rig.log.count("is no longer wanted, but the mesh needs it"), 1u);
  EXPECT_EQ(rig.mesh.node_count(), 5u);
  rig.bus.silence(1);
  rig.run(5s);
  EXPECT_EQ(rig.mesh.node_count(), 3u);
  EXPECT_EQ(rig.server.header("node_count"), 3u);
  EXPECT_TRUE(audit(rig.mesh));
}

}  // namespace
}  // namespace etcm::firmware
