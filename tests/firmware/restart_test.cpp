// A gateway that starts again serves the mesh it had, and catches up as the nodes answer.
#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>

#include "etcm/audit.h"
#include "fakes.h"
#include "firmware/persist/state_saver.h"
#include "memory_store.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

class Restart : public testing::Test {
 protected:
  // A gateway on the store that all gateways of a test share.
  std::unique_ptr<Rig> rig_of(const std::vector<FeatureSettings>& features,
                              std::uint32_t vertices_max = 100) {
    auto rig = std::make_unique<Rig>(features, vertices_max);
    rig->settings.state = StateSettings{.folder = "/state", .interval = 1s};
    rig->store = &store_;
    return rig;
  }
  // A fence with posts on either side, so that it needs Steiner vertices, grown one by one.
  static void populate(Rig& rig) {
    rig.put(1, 0, 0);
    rig.put(2, 1000, 10);
    for (std::uint8_t unit = 3; unit <= 12; ++unit) {
      rig.run(100ms);
      rig.put(unit, 80 * unit, unit % 2 == 0 ? 60 + unit : -40 - unit);
    }
    rig.run(2s);
  }
  static std::uint64_t hash_of(const Rig& rig) {
    return std::uint64_t{rig.server.header("mesh_hash_high")} << 32 |
           rig.server.header("mesh_hash_low");
  }
  const std::vector<FeatureSettings> fence_{feature(1001, 1002)};
  MemoryStore store_;
};

TEST_F(Restart, ServesTheLastMeshAtOnceAllStale) {
  const auto before = rig_of(fence_);
  populate(*before);
  ASSERT_GT(before->mesh.steiner_count(), 0u);
  const auto after = rig_of(fence_);
  after->start();
  after->gateway->restore(after->clock.now());
  // Before anything was asked.
  ASSERT_EQ(after->server.images.size(), 1u);
  EXPECT_EQ(hash_of(*after), hash_of(*before));
  EXPECT_EQ(after->server.header("node_count"), 12u);
  EXPECT_EQ(after->server.header("stale_count"), 12u);
  EXPECT_EQ(after->server.header("features_active"), 1u);
  EXPECT_EQ(after->server.header("state"), snapshot_state::stale);
  EXPECT_GT(after->gateway->generation(), before->gateway->generation());
  EXPECT_TRUE(audit(after->mesh));
  EXPECT_EQ(after->log.count("restored the mesh of generation " +
                             std::to_string(before->gateway->generation()) + ": 12 of 12 nodes"),
            1u);
}

// Such as a device that was given the serial of another by mistake.
TEST_F(Restart, WhoGetsItsSerialBackAfterItIsNoSecondNode) {
  const auto before = rig_of({});
  before->put_square();
  before->run(2s);
  const auto after = rig_of({});
  const auto answer_as = [&](std::uint32_t serial) {
    after->bus.set(
        1, {.serial = Serial{serial}, .position = {0, 0}, .status = node_status::fix_valid});
  };
  after->put_square();
  after->start();
  after->gateway->restore(after->clock.now());
  after->run(1s);
  answer_as(9);
  after->run(1s);
  EXPECT_EQ(after->log.count("node 9 is there now, node 1001 is not"), 1u)
      << testing::PrintToString(after->log.lines);
  answer_as(1001);
  after->run(4s);
  EXPECT_EQ(after->log.count("node 1001 is there now, node 9 is not"), 1u)
      << testing::PrintToString(after->log.lines);
  EXPECT_EQ(after->log.count("two nodes answer"), 0u);
}

// The state on the disk, with other bytes.
template <class Change>
std::vector<std::byte> changed_state(std::span<const std::byte> bytes, Change change) {
  SavedState state;
  EXPECT_EQ(decode_state(bytes, state), "");
  change(state);
  StateWriter writer(bytes.size() + 1000);
  writer.begin(state.generation, state.next_generation, state.mesh_hash, state.saved_at_s);
  if (state.is_canonical) writer.set_canonical();
  for (const std::string& bus : state.buses) writer.add_bus(bus);
  for (const SavedNode& node : state.nodes) writer.add(node);
  for (const Position anchor : state.anchors) writer.add(anchor);
  for (const SavedFeature& feature : state.features) writer.add(feature);
  for (const SteinerPlace& place : state.steiner) writer.add(place);
  const auto written = writer.finish();
  return {written.begin(), written.end()};
}

TEST_F(Restart, SavesNoSteinerVerticesThatBuildMakesAgain) {
  const auto before = rig_of(fence_);
  populate(*before);
  ASSERT_GT(before->mesh.steiner_count(), 0u);
  SavedState state;
  ASSERT_EQ(decode_state(store_.last, state), "");
  EXPECT_TRUE(state.is_canonical);
  EXPECT_TRUE(state.steiner.empty());
  EXPECT_EQ(state.mesh_hash, before->mesh.hash());
}

// As it is when there is no room to make it the one of build().
TEST_F(Restart, KeepsTheSteinerVerticesOfAMeshWithAHistory) {
  const auto before = rig_of(fence_);
  populate(*before);
  Mesh grown;
  std::vector<std::byte> memory(storage_bytes(before->mesh.config()));
  ASSERT_EQ(grown.open(memory, before->mesh.config()), Status::ok);
  store_.last = changed_state(store_.last, [&](SavedState& state) {
    // Nodes one after the other, so that the mesh is not the one of build().
    std::vector<VertexId> ids(state.nodes.size());
    FeatureId fence;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      ASSERT_EQ(grown.join(state.nodes[i].position, ids[i]), Status::ok);
      if (i == 1) {
        ASSERT_EQ(grown.add_feature({ids[0], ids[1]}, fence), Status::ok);
      }
    }
    state.is_canonical = false;
    state.mesh_hash = grown.hash();
    for (std::uint32_t value = 1; value < grown.vertex_id_end(); ++value) {
      const VertexId id{static_cast<IdValue>(value)};
      if (grown.kind(id) == VertexKind::steiner) state.steiner.push_back({0, grown.point(id)});
    }
  });
  ASSERT_NE(grown.hash(), before->mesh.hash());
  const auto after = rig_of(fence_);
  after->start();
  after->gateway->restore(after->clock.now());
  EXPECT_EQ(after->log.count("restored the mesh of generation"), 1u);
  EXPECT_EQ(hash_of(*after), hash_of(*before)) << "published without its history";
}

TEST_F(Restart, AMeshThatBuildMakesOtherwiseTodayIsThatOne) {
  const auto before = rig_of(fence_);
  populate(*before);
  store_.last = changed_state(store_.last, [](SavedState& state) { ++state.mesh_hash; });
  const auto after = rig_of(fence_);
  after->start();
  after->gateway->restore(after->clock.now());
  EXPECT_EQ(after->log.count("restored the nodes, not their mesh, of generation"), 1u);
  EXPECT_EQ(after->log.count("joined"), 0u);
  EXPECT_EQ(hash_of(*after), hash_of(*before));
  EXPECT_EQ(after->server.header("node_count"), 12u);
  EXPECT_EQ(after->server.header("features_active"), 1u);
}

TEST_F(Restart, NodesThatCannotBeTogetherAreNotInTheMesh) {
  const auto before = rig_of(fence_);
  populate(*before);
  store_.last = changed_state(
      store_.last, [](SavedState& state) { state.nodes[3].position = state.nodes[4].position; });
  const auto after = rig_of(fence_);
  after->start();
  after->gateway->restore(after->clock.now());
  EXPECT_EQ(after->log.count("restored the nodes, not their mesh, of generation"), 1u);
  EXPECT_EQ(after->server.header("node_count"), 11u);
  EXPECT_EQ(after->server.header("quarantined_count"), 1u);
  EXPECT_EQ(after->server.header("features_active"), 1u);
  EXPECT_TRUE(audit(after->mesh));
}

TEST_F(Restart, BeforeTheFirstMeshSaysNothingOfOne) {
  const auto before = rig_of(fence_);
  before->run(2s);
  before->gateway->finish(before->clock.now());
  before->gateway->finish_saving(before->clock.now());
  ASSERT_GT(store_.saves, 0u);
  const auto after = rig_of(fence_);
  after->start();
  after->gateway->restore(after->clock.now());
  EXPECT_EQ(after->log.count("restored"), 0u);
  populate(*after);
  EXPECT_EQ(after->server.header("node_count"), 12u);
}

TEST_F(Restart, AnchorsAreWhereTheyWere) {
  const auto site = [this](std::int32_t end_x) {
    auto rig = rig_of({{.from = FeatureEnd::anchor({-20, -90}),
                        .to = FeatureEnd::anchor({end_x, -90}),
                        .name = {},
                        .source = "site.geojson:1"},
                       feature(1001, 1002)});
    rig->settings.anchors = {{.position = {-20, -90}, .source = "site.geojson:1"},
                             {.position = {end_x, -90}, .source = "site.geojson:1"}};
    return rig;
  };
  const auto before = site(900);
  populate(*before);
  EXPECT_EQ(before->server.header("features_active"), 2u);
  const auto after = site(900);
  after->start();
  after->gateway->restore(after->clock.now());
  EXPECT_EQ(hash_of(*after), hash_of(*before));
  EXPECT_EQ(after->server.header("node_count"), 12u);
  EXPECT_EQ(after->server.header("features_active"), 2u);
  EXPECT_TRUE(audit(after->mesh));
  // Another site since then: the nodes come back, the mesh cannot.
  const auto moved = site(950);
  moved->start();
  moved->gateway->restore(moved->clock.now());
  EXPECT_EQ(moved->server.header("node_count"), 12u);
  EXPECT_EQ(moved->server.header("features_active"), 2u);
  EXPECT_EQ(moved->mesh.node_count(), 14u);
  EXPECT_TRUE(audit(moved->mesh));
}

TEST_F(Restart, ANodeOnAnAnchorIsThatAgain) {
  const auto site = [this] {
    auto rig = rig_of({{.from = FeatureEnd::anchor({0, 0}),
                        .to = FeatureEnd::anchor({900, -90}),
                        .name = {},
                        .source = "site.geojson:1"},
                       feature(1001, 1002)});
    rig->settings.anchors = {{.position = {0, 0}, .source = "site.geojson:1"},
                             {.position = {900, -90}, .source = "site.geojson:1"}};
    return rig;
  };
  const auto before = site();
  populate(*before);
  EXPECT_EQ(before->server.header("features_active"), 2u);
  EXPECT_EQ(before->server.header("anchor_count"), 1u);
  const auto after = site();
  after->put(20, 500, 500);
  after->start();
  after->gateway->restore(after->clock.now());
  EXPECT_EQ(after->log.count("restored the mesh of generation"), 1u);
  EXPECT_EQ(hash_of(*after), hash_of(*before));
  EXPECT_EQ(after->server.header("node_count"), 12u);
  EXPECT_EQ(after->server.header("anchor_count"), 1u);
  EXPECT_EQ(after->server.header("features_active"), 2u);
  // None of them answers, though another does: they leave, and the anchor is one again.
  after->run(6s);
  EXPECT_EQ(after->server.header("node_count"), 1u);
  EXPECT_EQ(after->server.header("anchor_count"), 2u);
  EXPECT_EQ(after->server.header("features_active"), 1u);
  EXPECT_TRUE(audit(after->mesh));
}

TEST_F(Restart, CatchesUpAsNodesAnswerAndLetsTheOthersLeaveInTheirTime) {
  const auto before = rig_of(fence_);
  populate(*before);
  const auto after = rig_of(fence_);
  after->start();
  after->gateway->restore(after->clock.now());
  for (std::uint8_t unit = 1; unit <= 11; ++unit) {
    after->put(unit,
               unit == 1   ? 0
               : unit == 2 ? 1000
                           : 80 * unit,
               unit == 1       ? 0
               : unit == 2     ? 10
               : unit % 2 == 0 ? 60 + unit
                               : -40 - unit);
  }
  after->run(500ms);
  EXPECT_EQ(hash_of(*after), hash_of(*before)) << "nobody moved";
  EXPECT_EQ(after->server.header("stale_count"), 1u);
  EXPECT_EQ(after->log.count("joined"), 0u);
  after->run(2300ms);
  EXPECT_EQ(after->mesh.node_count(), 12u);
  after->run(1s);
  EXPECT_EQ(after->mesh.node_count(), 11u);
  EXPECT_EQ(after->log.count("node 1012 left (silent)"), 1u);
  EXPECT_EQ(after->server.header("state"), snapshot_state::missing);
}

// The next save by itself is an hour away.
TEST_F(Restart, WhoWasDismissedStaysSoThoughThePowerFailsAtOnce) {
  const auto before = rig_of({});
  before->settings.state->interval = 1h;
  before->put_square();
  before->run(2s);
  before->bus.silence(3);
  before->run(10s);
  ASSERT_EQ(before->server.header("missing_count"), 1u);
  ASSERT_TRUE(before->gateway->dismiss(Serial{1003}));
  before->run(200ms);
  const auto after = rig_of({});
  after->start();
  after->gateway->restore(after->clock.now());
  after->run(10s);
  EXPECT_EQ(after->log.count("node 1003 is missing"), 0u)
      << testing::PrintToString(after->log.lines);
}

TEST_F(Restart, ANodeOfABusThatIsDownIsNotSaidToAnswerWithoutAFix) {
  const auto before = rig_of({});
  before->put_square();
  before->run(2s);
  before->bus.link_up = false;
  before->run(4s);
  before->gateway->finish(before->clock.now());
  const auto after = rig_of({});
  after->bus.link_up = false;
  after->start();
  after->gateway->restore(after->clock.now());
  after->run(5s);
  EXPECT_EQ(after->log.count("has no fix"), 0u) << testing::PrintToString(after->log.lines);
  EXPECT_EQ(after->server.header("stale_count"), 4u);
}

TEST_F(Restart, FollowsANodeThatMovedMeanwhile) {
  const auto before = rig_of({});
  before->put(1, 0, 0);
  before->put(2, 50, 0);
  before->run(2s);
  const auto after = rig_of({});
  after->put(1, 7, 7);
  after->put(9, 99, 99);
  after->start();
  after->gateway->restore(after->clock.now());
  after->run(500ms);
  EXPECT_EQ(after->log.count("node 1001 moved from (0, 0) to (7, 7)"), 1u);
  EXPECT_EQ(after->log.count("node 1009 joined"), 1u);
  EXPECT_EQ(after->mesh.node_count(), 3u);
}

TEST_F(Restart, KeepsTheNodeThatNowAnswersElsewhere) {
  const auto before = rig_of({});
  before->put(1, 0, 0);
  before->put(2, 50, 0);
  before->run(2s);
  const auto after = rig_of({});
  after->bus.set(7, {.serial = Serial{1001}, .position = {0, 0}, .status = node_status::fix_valid});
  after->put(2, 50, 0);
  after->start();
  after->gateway->restore(after->clock.now());
  after->run(2500ms);
  EXPECT_EQ(after->mesh.node_count(), 2u);
  EXPECT_EQ(after->server.header("stale_count"), 0u);
  EXPECT_EQ(after->log.count("joined"), 0u);
  after->run(5s);
  EXPECT_EQ(after->mesh.node_count(), 2u);
}

// As it would without a restart (admission_test.cpp).
TEST_F(Restart, WhoGetsItsSerialBackIsNoSecondNode) {
  const auto before = rig_of({});
  before->put(1, 0, 0);
  before->run(2s);
  const auto after = rig_of({});
  after->put(1, 0, 0);
  after->start();
  after->gateway->restore(after->clock.now());
  after->run(500ms);
  after->bus.set(1, {.serial = Serial{9}, .position = {50, 0}, .status = node_status::fix_valid});
  after->run(1s);
  EXPECT_EQ(after->log.count("node 9 is there now, node 1001 is not"), 1u);
  after->put(1, 0, 0);
  after->run(4s);
  EXPECT_EQ(after->log.count("node 1001 is there now, node 9 is not"), 1u);
  EXPECT_EQ(after->log.count("two nodes answer"), 0u);
}

TEST_F(Restart, NeverGoesBackInGenerationsWheneverThePowerFails) {
  std::uint32_t highest = 0;
  for (int life = 0; life < 8; ++life) {
    const auto rig = rig_of({});
    rig->put(1, 0, 0);
    rig->start();
    rig->gateway->restore(rig->clock.now());
    ASSERT_TRUE(life == 0 || rig->gateway->generation() > highest) << life;
    // A mesh that changes all the time, ended without a word after another while each time.
    for (int i = 0; i < 30 * life + 5; ++i) {
      rig->put(1, i, life);
      rig->run(100ms);
    }
    highest = rig->gateway->generation();
  }
}

TEST_F(Restart, FindsAMeshThatWasPublishedWheneverThePowerFails) {
  const auto rig = rig_of({});
  rig->settings.poll.interval = 70ms;
  rig->settings.state->interval = 1030ms;
  rig->put_square();
  rig->run(20ms);
  std::map<std::uint32_t, std::uint64_t> published;
  std::size_t checked = store_.saves;
  for (int step = 0; step < 3000; ++step) {
    rig->put(4, step / 7, 100 + step / 7);
    rig->run(10ms);
    published[rig->gateway->generation()] = hash_of(*rig);
    if (store_.saves == checked) continue;
    checked = store_.saves;
    SavedState state;
    ASSERT_EQ(decode_state(store_.last, state), "");
    // Before the first mesh only a promise about generations is saved.
    if (state.generation == 0) continue;
    ASSERT_EQ(state.mesh_hash, published.at(state.generation));
  }
  EXPECT_GT(checked, 20u);
}

TEST_F(Restart, GoesOnWithTheNextGenerationAfterAProperEnd) {
  const auto before = rig_of({});
  before->put(1, 0, 0);
  before->run(2s);
  before->put(1, 5, 0);
  before->run(200ms);
  before->gateway->finish(before->clock.now());
  before->gateway->finish_saving(before->clock.now());
  const auto after = rig_of({});
  after->start();
  after->gateway->restore(after->clock.now());
  EXPECT_EQ(after->gateway->generation(), before->gateway->generation() + 1);
  EXPECT_EQ(hash_of(*after), hash_of(*before));
  EXPECT_EQ(after->mesh.position(VertexId{1}), (Position{5, 0}));
}

TEST_F(Restart, TellsAtLeastTheAgeThatWasKnown) {
  const auto before = rig_of({});
  before->put(1, 0, 0);
  before->run(2s);
  before->put(1, 0, 0, 0);  // no fix any more
  before->run(10s);
  before->gateway->finish(before->clock.now());
  const auto after = rig_of({});
  after->start();
  after->gateway->restore(after->clock.now());
  EXPECT_GE(after->server.header("oldest_age_ms"), 10'000u);
}

TEST_F(Restart, WithOtherFeaturesKeepsTheNodes) {
  const auto before = rig_of(fence_);
  populate(*before);
  const auto after = rig_of({feature(1003, 1012)});
  after->start();
  after->gateway->restore(after->clock.now());
  EXPECT_EQ(after->mesh.node_count(), 12u);
  EXPECT_EQ(after->mesh.feature_count(), 1u);
  EXPECT_EQ(after->log.count("restored the nodes, not their mesh"), 1u);
  EXPECT_TRUE(audit(after->mesh));
}

TEST_F(Restart, WithMoreFeaturesKeepsTheMeshAndAddsThem) {
  const auto before = rig_of(fence_);
  populate(*before);
  const auto after = rig_of({feature(1003, 1005), feature(1002, 1001)});
  after->start();
  after->gateway->restore(after->clock.now());
  EXPECT_EQ(after->mesh.feature_count(), 2u);
  EXPECT_EQ(after->log.count("restored the mesh"), 1u);
  EXPECT_TRUE(audit(after->mesh));
}

TEST_F(Restart, WithLessRoomKeepsWhatFits) {
  const auto before = rig_of(fence_);
  populate(*before);
  const auto after = rig_of(fence_, 8);
  after->start();
  after->gateway->restore(after->clock.now());
  EXPECT_GE(after->mesh.node_count(), 6u);
  EXPECT_TRUE(audit(after->mesh));
  after->put(20, 500, 500);
  after->run(5s);
  EXPECT_EQ(after->mesh.node_count(), 1u) << "none of them answered";
}

TEST_F(Restart, OfAUnitThatIsAskedNoMoreLetsItLeave) {
  const auto before = rig_of({});
  before->put(20, 0, 0);
  before->run(2s);
  const auto after = rig_of({});
  after->settings.buses.front().units = {{.first = 1, .last = 10}};
  after->start();
  after->gateway->restore(after->clock.now());
  EXPECT_EQ(after->mesh.node_count(), 1u);
  after->run(4s);
  EXPECT_EQ(after->mesh.node_count(), 0u);
}

TEST_F(Restart, AfterADamagedStateBeginsAnew) {
  store_.last = {std::byte{1}, std::byte{2}};
  const auto rig = rig_of({});
  rig->put(1, 0, 0);
  rig->start();
  rig->gateway->restore(rig->clock.now());
  EXPECT_TRUE(rig->server.images.empty());
  rig->run(500ms);
  EXPECT_EQ(rig->gateway->generation(), 1u);
  EXPECT_EQ(rig->log.count("the last copy is not used, it is cut off"), 1u);
}

TEST_F(Restart, AFullDiskDisturbsNothing) {
  store_.why = "/state: cannot write the file (No space left on device); make room on that disk";
  const auto rig = rig_of(fence_);
  populate(*rig);
  rig->run(5s);
  EXPECT_EQ(rig->mesh.node_count(), 12u);
  EXPECT_EQ(rig->log.count("state is not saved"), 1u);
  store_.why.clear();
  rig->run(3s);
  EXPECT_EQ(rig->log.count("state is saved again"), 1u);
  const auto after = rig_of(fence_);
  after->start();
  after->gateway->restore(after->clock.now());
  EXPECT_EQ(hash_of(*after), hash_of(*rig));
}

}  // namespace
}  // namespace etcm::firmware
