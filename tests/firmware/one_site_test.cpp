// Which nodes and features are in the mesh depends on where the nodes are and on the site alone:
// whatever came first, moved, left or was configured before, the mesh and the quarantine are those
// of a gateway that finds everything as it is now.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "etcm/audit.h"
#include "fakes.h"
#include "firmware/mesh/node_placement.h"
#include "firmware/site/feature_meeting.h"
#include "geojson.h"
#include "inputs/random.h"
#include "support/emulated.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t serial_max = 9;
constexpr std::int32_t spacing = 12;  // lines often cross at places in whole units, often elsewhere
constexpr std::int32_t side = 5;

using Places = std::map<std::uint32_t, Position>;  // by serial

struct Outcome {
  std::uint64_t hash = 0;
  std::vector<std::uint32_t> in_mesh;                      // serials
  std::vector<std::pair<std::uint32_t, Status>> refused;   // serials
  std::vector<std::pair<std::uint32_t, Status>> kept_out;  // numbers of features
  std::vector<std::uint32_t> active;                       // numbers of features
  friend bool operator==(const Outcome&, const Outcome&) = default;
};

class World {
 public:
  explicit World(const Settings& settings) : settings_(settings) {
    memory_.resize(storage_bytes(settings_.mesh));
    if (mesh_.open(memory_, settings_.mesh) != Status::ok) throw std::logic_error("bad MeshConfig");
    kept_.emplace(mesh_, settings_);
    site_.emplace(*kept_, nodes_, clock_, log_);
    placement_.emplace(*kept_, *site_, nodes_, settings_, clock_, log_);
  }

  // As a reading of the node tells it.
  void put(std::uint32_t serial, Position position) {
    NodeRecord* node = nodes_.find(Serial{serial});
    if (node == nullptr) node = nodes_.add(Serial{serial}, clock_.now());
    node->position = position;
    if (!node->is_placed()) {
      placement_->join(*node, 1);
    } else if (node->position != node->placed) {
      placement_->move(*node, 1);
    } else {
      placement_->clear_rejection(*node);
    }
  }
  void remove(std::uint32_t serial) {
    NodeRecord* const node = nodes_.find(Serial{serial});
    if (node == nullptr) return;
    if (node->is_placed()) placement_->leave(*node, "silent", 1);
    placement_->clear_rejection(*node);
    nodes_.release(*node);
  }
  void reload(const Settings& settings) {
    settings_ = settings;
    placement_->update_site(settings_, 1);
  }
  void publish() {
    clock_.pass(1s);
    placement_->retry_rejected(1);
    placement_->settle(1);
    ASSERT_EQ(kept_->canonicalize(), Status::ok);
    ASSERT_TRUE(audit(mesh_));
  }
  const RecordingLog& log() const { return log_; }

  Outcome outcome() const {
    Outcome outcome{
        .hash = mesh_.hash(), .in_mesh = {}, .refused = {}, .kept_out = {}, .active = {}};
    for (const NodeRecord& node : nodes_.records()) {
      if (node.is_placed()) outcome.in_mesh.push_back(node.serial.value);
      if (!node.is_quarantined()) continue;
      const bool is_outside = node.rejection.domain != DomainPlace::inside;
      outcome.refused.emplace_back(node.serial.value,
                                   is_outside ? Status::bad_coordinate : node.rejection.mesh);
    }
    std::sort(outcome.in_mesh.begin(), outcome.in_mesh.end());
    std::sort(outcome.refused.begin(), outcome.refused.end());
    const auto records = std::as_const(*kept_).features().records();
    for (std::uint32_t number = 0; number < records.size(); ++number) {
      if (records[number].is_active()) outcome.active.push_back(number);
      if (records[number].rejection != Status::ok) {
        outcome.kept_out.emplace_back(number, records[number].rejection);
      }
    }
    return outcome;
  }

 private:
  Settings settings_;
  SimulatedClock clock_;
  RecordingLog log_;
  std::vector<std::byte> memory_;
  Mesh mesh_;
  NodeTable nodes_{100, 100};
  std::optional<KeptMesh> kept_;
  std::optional<SiteKeeper> site_;
  std::optional<NodePlacement> placement_;
};

// Room for everything at once, and for what a change takes meanwhile.
Settings roomy_settings() {
  Settings settings;
  settings.mesh = {.vertices_max = 2000, .features_max = 1000};
  return settings;
}

Position some_place(inputs::Random& random) {
  return {spacing * random.between(0, side), spacing * random.between(0, side)};
}

Settings some_site(inputs::Random& random) {
  Settings settings = roomy_settings();
  std::vector<FeatureSettings> features;
  const auto some_end = [&] {
    if (random.below(3) != 0) {
      return FeatureEnd(Serial{1 + static_cast<std::uint32_t>(random.below(serial_max))});
    }
    const Position place = some_place(random);
    return at(place.x, place.y);
  };
  for (std::uint64_t left = random.below(14); left-- > 0;) {
    const FeatureEnd from = some_end();
    const FeatureEnd to = some_end();
    if (!(from == to)) features.push_back(line(from, to));
  }
  draw(settings, features);
  if (random.below(3) == 0) settings.domain = square(0, spacing * random.between(3, side));
  return settings;
}

Places some_places(inputs::Random& random) {
  Places places;
  for (std::uint32_t serial = 1; serial <= serial_max; ++serial) {
    if (random.below(4) != 0) places[serial] = some_place(random);
  }
  return places;
}

// What the nodes and the site come to, from the rules alone and a mesh that is built at once.
Outcome expected(const Settings& settings, const Places& places) {
  std::vector<std::byte> memory(storage_bytes(settings.mesh));
  Mesh mesh;
  EXPECT_EQ(mesh.open(memory, settings.mesh), Status::ok);
  Outcome outcome;
  std::map<std::pair<std::int32_t, std::int32_t>, VertexId> at;
  std::map<std::uint64_t, VertexId> ends;
  for (const AnchorSettings& anchor : settings.anchors) {
    VertexId& id = at[{anchor.position.x, anchor.position.y}];
    EXPECT_EQ(mesh.join(anchor.position, id), Status::ok);
    ends[FeatureEnd::anchor(anchor.position).key()] = id;
  }
  std::map<std::pair<std::int32_t, std::int32_t>, std::uint32_t> holder;
  for (const auto& [serial, position] : places) {
    if (settings.domain.place_of(position) != DomainPlace::inside) {
      outcome.refused.emplace_back(serial, Status::bad_coordinate);
      continue;
    }
    const auto place = std::pair{position.x, position.y};
    if (!holder.emplace(place, serial).second) {
      outcome.refused.emplace_back(serial, Status::duplicate_vertex);
      continue;
    }
    if (!at.contains(place)) {
      EXPECT_EQ(mesh.join(position, at[place]), Status::ok);
    }
    ends[FeatureEnd(Serial{serial}).key()] = at[place];
    outcome.in_mesh.push_back(serial);
  }
  // Features that come by increasing numbers give way to those that are there already.
  for (std::uint32_t number = 0; number < settings.features.size(); ++number) {
    const auto from = ends.find(settings.features[number].from.key());
    const auto to = ends.find(settings.features[number].to.key());
    if (from == ends.end() || to == ends.end()) continue;
    FeatureId id;
    const Status status = mesh.add_feature({from->second, to->second}, id);
    if (status == Status::ok) {
      outcome.active.push_back(number);
    } else {
      outcome.kept_out.emplace_back(number, status);
    }
  }
  EXPECT_EQ(mesh.rebuild(), Status::ok);
  outcome.hash = mesh.hash();
  return outcome;
}

// Of several features in the way of one it is the first that the reason is about.
Outcome without_reasons(Outcome outcome) {
  for (auto& [number, status] : outcome.kept_out) status = Status::crossing_features;
  return outcome;
}

void live(World& world, inputs::Random& random, int events) {
  for (int event = 0; event < events; ++event) {
    const std::uint32_t serial = 1 + static_cast<std::uint32_t>(random.below(serial_max));
    switch (random.below(12)) {
      case 0:
        world.reload(some_site(random));
        break;
      case 1:
      case 2:
        world.remove(serial);
        break;
      case 3:
        world.publish();
        break;
      default:
        world.put(serial, some_place(random));
    }
  }
}

// Each node goes where it is in the end, or leaves, in some order; the site comes in between.
void settle_down(World& world, inputs::Random& random, const Settings& site, const Places& places) {
  std::vector<std::uint32_t> order;
  for (std::uint32_t serial = 0; serial <= serial_max; ++serial) order.push_back(serial);
  inputs::shuffle(order, random);
  for (const std::uint32_t serial : order) {
    if (serial == 0) {
      world.reload(site);
    } else if (const auto found = places.find(serial); found != places.end()) {
      world.put(serial, found->second);
    } else {
      world.remove(serial);
    }
  }
  world.publish();
}

TEST(OneSite, AnyHistoryEndsAsIfAllHadComeAtOnce) {
  for (std::uint64_t seed = 0; seed < 400u / test::thinning_if_emulated; ++seed) {
    inputs::Random random(seed);
    const Settings site = some_site(random);
    const Places places = some_places(random);
    World at_once(site);
    for (const auto& [serial, position] : places) at_once.put(serial, position);
    at_once.publish();
    const Outcome wanted = at_once.outcome();
    ASSERT_EQ(without_reasons(wanted), without_reasons(expected(site, places))) << seed;
    for (int history = 0; history < 4; ++history) {
      World world(some_site(random));
      live(world, random, 40);
      settle_down(world, random, site, places);
      ASSERT_EQ(world.outcome(), wanted) << "seed " << seed << ", history " << history;
    }
  }
}

TEST(OneSite, WhatMeetsIsWhatTheMeshRefuses) {
  inputs::Random random(7);
  for (int round = 0; round < 20'000 / test::thinning_if_emulated; ++round) {
    std::vector<Position> ends;
    for (int i = 0; i < 4; ++i) ends.push_back({random.between(0, 6), random.between(0, 6)});
    if (ends[0] == ends[1] || ends[2] == ends[3]) continue;
    const Meeting meeting = meeting_of({ends[0], ends[1]}, {ends[2], ends[3]});
    ASSERT_EQ(meeting_of({ends[3], ends[2]}, {ends[1], ends[0]}).status, meeting.status);
    const MeshConfig config{.vertices_max = 100, .features_max = 20};
    std::vector<std::byte> memory(storage_bytes(config));
    Mesh mesh;
    ASSERT_EQ(mesh.open(memory, config), Status::ok);
    VertexId id[4];
    for (std::size_t i = 0; i < 4; ++i) {
      if (mesh.join(ends[i], id[i]) == Status::duplicate_vertex) id[i] = mesh.error_detail().vertex;
    }
    FeatureId feature;
    ASSERT_EQ(mesh.add_feature({id[0], id[1]}, feature), Status::ok);
    ASSERT_EQ(mesh.add_feature({id[2], id[3]}, feature), meeting.status) << round;
    EXPECT_EQ(meeting.near_crossing.has_value(), meeting.status == Status::crossing_features);
    if (!meeting.crossing) continue;
    EXPECT_EQ(meeting.near_crossing, meeting.crossing);
    EXPECT_TRUE(runs_through({ends[0], ends[1]}, *meeting.crossing));
    EXPECT_TRUE(runs_through({ends[2], ends[3]}, *meeting.crossing));
    VertexId middle;
    ASSERT_EQ(mesh.join(*meeting.crossing, middle), Status::ok);
    ASSERT_EQ(mesh.add_feature({id[2], id[3]}, feature), Status::ok) << "a node stands there";
  }
}

TEST(OneSite, LinesAreComparedExactlyAtTheEdgesOfTheMesh) {
  constexpr std::int32_t far = position_max;
  const FeatureLine diagonal{{-far, -far}, {far, far}};
  EXPECT_EQ(meeting_of(diagonal, {{-far, far}, {far, -far}}).crossing, (Position{0, 0}));
  EXPECT_EQ(meeting_of({{0, 0}, {10, 3}}, {{4, 5}, {4, -5}}).crossing, std::nullopt);
  EXPECT_EQ(meeting_of({{0, 0}, {10, 3}}, {{4, 5}, {4, -5}}).near_crossing, (Position{4, 1}));
  const Meeting flat = meeting_of(diagonal, {{-far, -far + 1}, {far, far - 1}});
  EXPECT_EQ(flat.status, Status::crossing_features);
  EXPECT_EQ(flat.crossing, (Position{0, 0}));
  EXPECT_EQ(meeting_of(diagonal, {{-far, -far + 1}, {far, far}}).status, Status::ok);
  const Meeting between = meeting_of(diagonal, {{-far, -far + 1}, {far, far - 2}});
  EXPECT_EQ(between.status, Status::crossing_features);
  EXPECT_FALSE(between.crossing.has_value());
}

// The whole gateway, over a bus, with reloads.
class OneGateway : public testing::Test {
 protected:
  static Settings merged(Settings settings, const Settings& site) {
    settings.features = site.features;
    settings.anchors = site.anchors;
    settings.domain = site.domain;
    return settings;
  }
  static Serial serial_of(std::uint32_t number) { return Serial{1000u + number}; }
  // Serials as Rig::put() makes them.
  static Settings site_of(inputs::Random& random) {
    Settings site = some_site(random);
    for (FeatureSettings& feature : site.features) {
      for (FeatureEnd* const end : {&feature.from, &feature.to}) {
        if (!end->is_anchor) *end = FeatureEnd(serial_of(end->serial.value));
      }
    }
    return site;
  }
  static void reload(Rig& rig, const Settings& site) {
    rig.settings = merged(rig.settings, site);
    rig.update_settings();
  }
  static void put(Rig& rig, const Places& places) {
    for (std::uint32_t serial = 1; serial <= serial_max; ++serial) {
      const auto unit = static_cast<std::uint8_t>(serial);
      const auto found = places.find(serial);
      if (found == places.end()) {
        rig.bus.silence(unit);
      } else {
        rig.put(unit, found->second.x, found->second.y);
      }
    }
    // One that is always there, so that the bus is never silent.
    rig.put(20, -50, -50);
  }
  using Entry = std::tuple<std::uint32_t, std::uint32_t, std::int32_t, std::int32_t, std::string>;
  static std::vector<Entry> quarantine_of(const Rig& rig) {
    std::vector<Entry> entries;
    for (const QuarantineEntry& entry : rig.gateway->quarantine()) {
      entries.emplace_back(entry.serial.value, entry.feature, entry.position.x, entry.position.y,
                           explain(entry));
    }
    std::sort(entries.begin(), entries.end());
    return entries;
  }
};

TEST_F(OneGateway, AnyHistoryEndsAsIfAllHadComeAtOnce) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    inputs::Random random(1000 + seed);
    const Settings site = site_of(random);
    const Places places = some_places(random);
    Rig at_once;
    at_once.settings.mesh = roomy_settings().mesh;
    at_once.settings = merged(at_once.settings, site);
    put(at_once, places);
    at_once.run(8s);
    Rig rig;
    rig.settings.mesh = roomy_settings().mesh;
    rig.settings = merged(rig.settings, site_of(random));
    for (int event = 0; event < 12; ++event) {
      put(rig, some_places(random));
      rig.run(random.below(4) == 0 ? 5s : 250ms);
      if (random.below(3) == 0) reload(rig, site_of(random));
    }
    reload(rig, site);
    put(rig, places);
    rig.run(8s);
    EXPECT_EQ(rig.mesh.hash(), at_once.mesh.hash()) << seed;
    EXPECT_EQ(quarantine_of(rig), quarantine_of(at_once)) << seed;
    EXPECT_EQ(rig.server.header("mesh_hash_low"), at_once.server.header("mesh_hash_low"));
    EXPECT_EQ(rig.server.header("features_active"), at_once.server.header("features_active"));
    EXPECT_EQ(rig.server.header("node_count"), at_once.server.header("node_count"));
  }
}

}  // namespace
}  // namespace etcm::firmware
