// What is saved and when, and what of it is believed.
#include "firmware/persist/state_saver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "fakes.h"
#include "firmware/config/unit_count.h"
#include "firmware/records/node_table.h"
#include "memory_store.h"
#include "support/allocation_watch.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

Settings settings_with_state() {
  Settings settings;
  settings.mesh = {.vertices_max = 100, .features_max = 10};
  for (const char* const name : {"yard", "gate"}) {
    settings.buses.emplace_back();
    settings.buses.back().name = name;
  }
  settings.state = StateSettings{.folder = "/state", .interval = 1min};
  return settings;
}

void write_all(StateWriter& writer) {
  writer.add_bus("yard");
  writer.add_bus("gate");
  writer.add(SavedNode{
      .serial = Serial{1001}, .position = {-5, 7}, .age_ms = 123456, .bus = 0, .address = 7});
  writer.add(SavedNode{.serial = Serial{0xfffffffe},
                       .position = {9, -9},
                       .age_ms = 0,
                       .bus = 1,
                       .address = 1,
                       .is_silent = true,
                       .silence_s = 3'000'000});
  writer.add(SavedNode{.serial = Serial{3}, .position = {0, 0}});
  writer.add(Position{position_max, -position_max});
  writer.add(SavedFeature{.from = 0, .to = 3});
  writer.add(SteinerPlace{.feature = 0, .point = {-(std::int64_t{1} << 51), 77}});
  writer.add(SavedMissing{.node = {.serial = Serial{17},
                                   .position = {4, -4},
                                   .age_ms = 99'000,
                                   .bus = 1,
                                   .address = 9,
                                   .silence_s = 5'000'000},
                          .has_position = true});
  writer.add(SavedMissing{.node = {.serial = Serial{18}, .silence_s = 31}});
}

constexpr std::int64_t saved_at_s = 1'800'000'000;
constexpr std::size_t quantities_size = 9 + 5;
constexpr std::size_t sensor_size_saved = 124;

// Each number differs from the others.
LearnedSensor learned_sensor() {
  return {.serial = Serial{1001},
          .quantity = QuantityIndex{1},
          .definition = 0xfedcba9876543210,
          .point = {-(std::int64_t{1} << 51), 78},
          .age_s = 61,
          .sample_count = 240,
          .reference = -1.5e99,
          .followed = 0.1,
          .has_slow_change = true,
          .slow_change = -3e-99,
          .slow_residual = -10,
          .residual = 4,
          .roughness = 5,
          .step = 11,
          .wander = 12,
          .residual_count = 1440,
          .roughness_count = 7,
          .step_count = 13,
          .wander_count = 1439,
          .is_noisy = true,
          .rise = 8,
          .fall = 9,
          .disagrees = true,
          .ended_alarms = 2};
}

void write_learned(StateWriter& writer) {
  writer.add(Quantity{"level", "cm"});
  writer.add(Quantity{"wet", ""});
  writer.add(learned_sensor());
}

std::vector<std::byte> example() {
  StateWriter writer(1000);
  writer.begin(41, 99, 0x0123456789abcdef, saved_at_s);
  write_all(writer);
  write_learned(writer);
  const auto bytes = writer.finish();
  return {bytes.begin(), bytes.end()};
}

TEST(SavedStateForm, SaysAgainWhatWasWritten) {
  SavedState state;
  ASSERT_EQ(decode_state(example(), state), "");
  EXPECT_EQ(state.generation, 41u);
  EXPECT_EQ(state.next_generation, 99u);
  EXPECT_EQ(state.mesh_hash, 0x0123456789abcdefu);
  EXPECT_EQ(state.buses, (std::vector<std::string>{"yard", "gate"}));
  ASSERT_EQ(state.nodes.size(), 3u);
  EXPECT_EQ(state.nodes[0].serial, Serial{1001u});
  EXPECT_EQ(state.nodes[0].position, (Position{-5, 7}));
  EXPECT_EQ(state.nodes[0].age_ms, 123456u);
  EXPECT_EQ(state.nodes[0].address, 7);
  EXPECT_EQ(state.nodes[1].bus, 1);
  EXPECT_FALSE(state.nodes[0].is_silent);
  EXPECT_TRUE(state.nodes[1].is_silent);
  EXPECT_EQ(state.nodes[1].silence_s, 3'000'000u);
  EXPECT_EQ(state.nodes[2].bus, no_saved_bus);
  EXPECT_EQ(state.anchors, (std::vector{Position{position_max, -position_max}}));
  ASSERT_EQ(state.features.size(), 1u);
  EXPECT_EQ(state.features[0].to, 3u);
  ASSERT_EQ(state.steiner.size(), 1u);
  EXPECT_EQ(state.steiner[0].point, (Point{-(std::int64_t{1} << 51), 77}));
  ASSERT_EQ(state.missing.size(), 2u);
  EXPECT_EQ(state.missing[0].node.serial, Serial{17u});
  EXPECT_EQ(state.missing[0].node.position, (Position{4, -4}));
  EXPECT_EQ(state.missing[0].node.age_ms, 99'000u);
  EXPECT_EQ(state.missing[0].node.bus, 1);
  EXPECT_EQ(state.missing[0].node.address, 9);
  EXPECT_TRUE(state.missing[0].has_position);
  EXPECT_EQ(state.missing[0].node.silence_s, 5'000'000u);
  EXPECT_FALSE(state.missing[1].has_position);
  EXPECT_EQ(state.saved_at_s, saved_at_s);
  EXPECT_EQ(state.quantities, (std::vector<Quantity>{{"level", "cm"}, {"wet", ""}}));
  EXPECT_EQ(state.sensors, std::vector{learned_sensor()});
}

// What a gateway has left on the disk that kept silences of missing nodes alone.
std::vector<std::byte> form_4() {
  auto bytes = example();
  bytes[0] = std::byte{4};
  for (std::size_t node = 3; node-- > 0;) {
    const auto silence = bytes.begin() + 64 + 5 + 5 + static_cast<std::ptrdiff_t>(24 * node) + 20;
    silence[-1] = std::byte{0};
    bytes.erase(silence, silence + 4);
  }
  return bytes;
}

// One that always saved the Steiner vertices.
std::vector<std::byte> form_3() {
  auto bytes = form_4();
  bytes[0] = std::byte{3};
  bytes.erase(bytes.begin() + 60, bytes.begin() + 64);  // the flags
  return bytes;
}

// One that learned nothing of sensors.
std::vector<std::byte> form_2() {
  auto bytes = form_3();
  bytes[0] = std::byte{2};
  bytes.erase(bytes.begin() + 44, bytes.begin() + 60);  // two counts and the time
  bytes.resize(bytes.size() - quantities_size - sensor_size_saved);
  return bytes;
}

TEST(SavedStateForm, TellsAMeshThatBuildMakesFromAnother) {
  StateWriter writer(1000);
  SavedState state;
  writer.begin(7, 8, 0);
  writer.set_canonical();
  ASSERT_EQ(decode_state(writer.finish(), state), "");
  EXPECT_TRUE(state.is_canonical);
  writer.begin(7, 8, 0);
  ASSERT_EQ(decode_state(writer.finish(), state), "");
  EXPECT_FALSE(state.is_canonical);
}

TEST(SavedStateForm, TellsTheLastOfARunFromAnother) {
  StateWriter writer(1000);
  SavedState state;
  writer.begin(7, 8, 0);
  writer.set_last();
  ASSERT_EQ(decode_state(writer.finish(), state), "");
  EXPECT_TRUE(state.is_last);
  writer.begin(7, 8, 0);
  ASSERT_EQ(decode_state(writer.finish(), state), "");
  EXPECT_FALSE(state.is_last);
}

TEST(SavedStateForm, ReadsForm4) {
  const auto bytes = form_4();
  SavedState state;
  ASSERT_EQ(decode_state(bytes, state), "");
  ASSERT_EQ(state.nodes.size(), 3u);
  EXPECT_EQ(state.nodes[1].serial, Serial{0xfffffffe});
  EXPECT_FALSE(state.nodes[1].is_silent);
  ASSERT_EQ(state.missing.size(), 2u);
  EXPECT_EQ(state.missing[0].node.silence_s, 5'000'000u);
  EXPECT_EQ(state.sensors, std::vector{learned_sensor()});
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_EQ(decode_state(std::span(bytes).first(size), state), "it is cut off") << size;
  }
}

TEST(SavedStateForm, ReadsForm3) {
  const auto bytes = form_3();
  SavedState state;
  ASSERT_EQ(decode_state(bytes, state), "");
  EXPECT_FALSE(state.is_canonical);
  EXPECT_EQ(state.buses, (std::vector<std::string>{"yard", "gate"}));
  EXPECT_EQ(state.steiner.size(), 1u);
  EXPECT_EQ(state.sensors, std::vector{learned_sensor()});
  EXPECT_EQ(state.saved_at_s, saved_at_s);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_EQ(decode_state(std::span(bytes).first(size), state), "it is cut off") << size;
  }
}

TEST(SavedStateForm, ReadsForm2) {
  const auto bytes = form_2();
  SavedState state;
  ASSERT_EQ(decode_state(bytes, state), "");
  ASSERT_EQ(state.nodes.size(), 3u);
  EXPECT_EQ(state.nodes[0].serial, Serial{1001u});
  ASSERT_EQ(state.missing.size(), 2u);
  EXPECT_EQ(state.missing[0].node.silence_s, 5'000'000u);
  EXPECT_TRUE(state.sensors.empty());
  EXPECT_EQ(state.saved_at_s, 0);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_EQ(decode_state(std::span(bytes).first(size), state), "it is cut off") << size;
  }
}

// What a gateway of the time before nodes could be missing has left on the disk.
TEST(SavedStateForm, ReadsForm1) {
  auto bytes = form_2();
  bytes[0] = std::byte{1};
  bytes.erase(bytes.begin() + 40, bytes.begin() + 44);  // the count of missing nodes
  bytes.resize(bytes.size() - 2 * 24);
  SavedState state;
  ASSERT_EQ(decode_state(bytes, state), "");
  EXPECT_EQ(state.generation, 41u);
  ASSERT_EQ(state.nodes.size(), 3u);
  EXPECT_EQ(state.nodes[0].serial, Serial{1001u});
  ASSERT_EQ(state.steiner.size(), 1u);
  EXPECT_EQ(state.steiner[0].point, (Point{-(std::int64_t{1} << 51), 77}));
  EXPECT_TRUE(state.missing.empty());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_EQ(decode_state(std::span(bytes).first(size), state), "it is cut off") << size;
  }
}

TEST(SavedStateForm, IsTheOneItsHeaderDescribes) {
  const auto bytes = example();
  EXPECT_EQ(bytes.size(),
            64u + 5 + 5 + 3 * 24 + 8 + 8 + 20 + 2 * 24 + quantities_size + sensor_size_saved);
  const auto at = [&](std::size_t i) { return std::to_integer<unsigned>(bytes[i]); };
  EXPECT_EQ(at(0), 6u);
  EXPECT_EQ(at(4), 41u);
  EXPECT_EQ(at(8), 99u);
  EXPECT_EQ(at(12), 0xefu);
  EXPECT_EQ(at(19), 0x01u);
  EXPECT_EQ((std::vector{at(20), at(24), at(28), at(32), at(36), at(40), at(44), at(48)}),
            (std::vector{2u, 3u, 1u, 1u, 1u, 2u, 2u, 1u}));
  EXPECT_EQ(at(52), saved_at_s & 0xff);
  EXPECT_EQ(at(60), 0u);
  EXPECT_EQ(at(64), 4u);
  EXPECT_EQ(at(65), unsigned{'y'});
  EXPECT_EQ(at(74), 1001u & 0xff);
  const std::size_t sensor = bytes.size() - sensor_size_saved;
  EXPECT_EQ(at(sensor), 1001u & 0xff);
  EXPECT_EQ(at(sensor + 4), 1u);
  EXPECT_EQ(at(sensor + 6), 7u | 2u << 3);
  EXPECT_EQ(at(sensor + 7), 240u);
  EXPECT_EQ(at(sensor + 8), 0x10u);
  EXPECT_EQ(at(sensor + 24), 78u);
  EXPECT_EQ(at(sensor + 32), 61u);
  EXPECT_EQ(at(bytes.size() - 6), 7u);
  EXPECT_EQ(at(bytes.size() - 4), 13u);
  EXPECT_EQ(at(bytes.size() - 2), 1439u & 0xff);
}

TEST(SavedStateForm, SaysWhatItsPositionsCountIn) {
  const DocumentPlane about{.is_about_place = true, .unit = 100, .x = -9'876'543'210, .y = 7};
  const DocumentPlane drawn{.crs = std::string(255, 'c'), .unit = 1, .x = 3, .y = -4};
  const std::vector<std::byte> fleet(3, std::byte{7});
  for (const DocumentPlane& plane : {about, drawn}) {
    StateWriter writer(1000);
    writer.begin(41, 99, 7, saved_at_s);
    write_all(writer);
    writer.add(plane);
    writer.add_fleet(fleet);
    const auto bytes = writer.finish();
    SavedState state;
    ASSERT_EQ(decode_state(bytes, state), "");
    EXPECT_EQ(state.plane, plane);
    EXPECT_EQ(state.fleet, fleet);
    EXPECT_EQ(decode_state(bytes.first(bytes.size() - fleet.size() - 1), state), "it is cut off");
  }
  SavedState state;
  ASSERT_EQ(decode_state(example(), state), "");
  EXPECT_EQ(state.plane, std::nullopt);

  StateWriter writer(1000);
  writer.begin(41, 99, 7, saved_at_s);
  writer.add(DocumentPlane{.crs = std::string(256, 'c'), .unit = 1});
  ASSERT_EQ(decode_state(writer.finish(), state), "");
  EXPECT_EQ(state.plane, std::nullopt) << "its name is too long to be kept";
  writer.begin(41, 99, 7, saved_at_s);
  writer.add(DocumentPlane{.unit = 0});
  EXPECT_EQ(decode_state(writer.finish(), state), "its plane has no unit");
}

TEST(SavedStateForm, RefusesWhatIsCutOffOrTooLong) {
  const auto bytes = example();
  SavedState state;
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_EQ(decode_state(std::span(bytes).first(size), state), "it is cut off") << size;
  }
  auto longer = bytes;
  longer.push_back({});
  EXPECT_EQ(decode_state(longer, state), "it is too long");
}

TEST(SavedStateForm, RefusesOtherVersions) {
  auto bytes = example();
  SavedState state;
  bytes[0] = std::byte{7};
  EXPECT_EQ(decode_state(bytes, state), "it is from a newer gateway (form 7, this one knows 6)");
  bytes[0] = std::byte{0};
  EXPECT_EQ(decode_state(bytes, state), "it is from an older gateway (form 0, this one knows 6)");
}

TEST(SavedStateForm, TakesNoMemoryForCountsThatCannotBe) {
  for (std::size_t count = 20; count < 52; count += 4) {
    auto bytes = example();
    for (std::size_t i = 0; i < 4; ++i) bytes[count + i] = std::byte{0xff};
    SavedState state;
    EXPECT_EQ(decode_state(bytes, state), "it is cut off") << count;
  }
}

TEST(SavedStateForm, AnyByteChangedIsReadWithoutHarm) {
  const auto bytes = example();
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    for (const int value : {0x00, 0x01, 0x7f, 0x80, 0xff}) {
      auto changed = bytes;
      changed[i] = static_cast<std::byte>(value);
      SavedState state;
      if (!decode_state(changed, state).empty()) continue;
      for (const SavedFeature& feature : state.features) {
        ASSERT_LT(std::max(feature.from, feature.to), state.nodes.size() + state.anchors.size());
      }
      for (const LearnedSensor& sensor : state.sensors) {
        ASSERT_LT(sensor.quantity.value, state.quantities.size());
        ASSERT_TRUE(std::isfinite(sensor.reference + sensor.followed + sensor.residual));
      }
    }
  }
}

TEST(SavedStateForm, RefusesWhatContradictsItself) {
  StateWriter writer(1000);
  SavedState state;
  writer.begin(7, 7, 0);
  EXPECT_EQ(decode_state(writer.finish(), state), "its generations contradict each other");
  writer.begin(7, 8, 0);
  writer.add(SavedNode{.serial = Serial{5}});
  writer.add(SavedNode{.serial = Serial{5}});
  EXPECT_EQ(decode_state(writer.finish(), state), "two nodes have one serial");
  writer.begin(7, 8, 0);
  writer.add(SavedNode{.serial = Serial{5}});
  writer.add(SavedMissing{.node = {.serial = Serial{5}}});
  EXPECT_EQ(decode_state(writer.finish(), state), "two nodes have one serial");
  writer.begin(7, 8, 0);
  writer.add(SavedMissing{.node = {.serial = Serial{5}, .bus = 0}});
  EXPECT_EQ(decode_state(writer.finish(), state), "node 5 is on a bus it does not name");
  writer.begin(7, 8, 0);
  writer.add(SavedNode{.serial = Serial{5}, .bus = 0});
  EXPECT_EQ(decode_state(writer.finish(), state), "node 5 is on a bus it does not name");
  writer.begin(7, 8, 0);
  writer.add(SavedNode{.serial = Serial::none()});
  EXPECT_EQ(decode_state(writer.finish(), state), "a node has no serial");
  writer.begin(7, 8, 0);
  writer.add(SavedFeature{.from = 0, .to = 0});
  EXPECT_EQ(decode_state(writer.finish(), state), "a feature ends at no node");
  writer.begin(7, 8, 0);
  writer.set_canonical();
  writer.add(SteinerPlace{});
  EXPECT_EQ(decode_state(writer.finish(), state), "its mesh contradicts itself");
  writer.begin(7, 8, 0);
  writer.add(SteinerPlace{.feature = 0, .point = {}});
  EXPECT_EQ(decode_state(writer.finish(), state), "a Steiner vertex is on no feature");
  writer.begin(7, 8, 0);
  writer.add(Quantity{"level", "m"});
  writer.add(learned_sensor());
  EXPECT_EQ(decode_state(writer.finish(), state), "a sensor measures what it does not name");
  writer.begin(7, 8, 0);
  write_learned(writer);
  LearnedSensor sensor = learned_sensor();
  sensor.roughness = std::numeric_limits<double>::quiet_NaN();
  writer.add(sensor);
  EXPECT_EQ(decode_state(writer.finish(), state), "what it says of a sensor is no number");
  writer.begin(7, 8, 0);
  write_learned(writer);
  sensor = learned_sensor();
  sensor.wander = std::numeric_limits<double>::infinity();
  writer.add(sensor);
  EXPECT_EQ(decode_state(writer.finish(), state), "what it says of a sensor is no number");
}

TEST(SavedStateForm, WhatIsLearnedIsContentOnceInAWhile) {
  StateWriter writer(1000);
  const auto content = [&](std::uint32_t edition, double reference, std::int64_t time) {
    writer.begin(7, 8, 0, time);
    writer.add(Quantity{"level", "m"});
    LearnedSensor sensor = learned_sensor();
    sensor.reference = reference;
    writer.add(sensor);
    writer.set_edition(edition);
    static_cast<void>(writer.finish());
    return writer.content();
  };
  EXPECT_EQ(content(1, 5, 100), content(1, 6, 200));
  EXPECT_NE(content(1, 5, 100), content(2, 5, 100));
}

TEST(SavedStateForm, FitsWhatASettingAllows) {
  Settings settings = settings_with_state();
  settings.buses.front().name = std::string(300, 'n');
  settings.buses.front().units = {{.first = 1, .last = 200}, {.first = 150, .last = 210}};
  Profile profile;
  profile.name = "meter";
  profile.readings.push_back({.name = std::string(reading_name_max, 'n'),
                              .unit = std::string(reading_unit_max, 'u'),
                              .value = {},
                              .valid = {}});
  settings.device_profiles = {profile};
  settings.buses.front().devices = {{.units = {{.first = 1, .last = 20}}, .profile = "meter"}};
  const Quantity quantity{profile.readings[0].name, profile.readings[0].unit};
  const std::size_t size_max = saved_state_size_max(settings);
  StateWriter writer(size_max);
  const test::AllocationWatch watch;
  writer.begin(1, 2, 0);
  for (const BusSettings& bus : settings.buses) writer.add_bus(bus.name);
  for (std::uint32_t i = 0; i < 50; ++i) writer.add(SavedNode{.serial = Serial{i}});
  for (std::uint32_t i = 0; i < 10; ++i) writer.add(SavedFeature{.from = i, .to = i + 1});
  for (std::uint32_t i = 0; i < 50; ++i) writer.add(SteinerPlace{});
  const std::uint32_t known = node_record_capacity(count_units(settings));
  for (std::uint32_t i = 0; i < known; ++i) writer.add(SavedMissing{});
  writer.add(quantity);
  for (int i = 0; i < 20; ++i) writer.add(learned_sensor());
  EXPECT_LE(writer.finish().size(), size_max);
  EXPECT_EQ(watch.allocations(), 0u);
}

class StateSaverTest : public testing::Test {
 protected:
  // What the gateway does in a step.
  void step(std::int32_t x) {
    saver_.step(clock_.now());
    if (!saver_.is_due(clock_.now())) return;
    StateWriter& writer = saver_.begin(generation_, static_cast<std::uint64_t>(x));
    writer.add_bus("yard");
    writer.add(SavedNode{.serial = Serial{1}, .position = {x, 0}});
    saver_.save(clock_.now());
  }
  SavedState saved() const {
    SavedState state;
    EXPECT_EQ(decode_state(store_.last, state), "");
    return state;
  }
  const Settings settings_ = settings_with_state();
  SimulatedClock clock_;
  RecordingLog log_;
  MemoryStore store_;
  StateSaver saver_{settings_, 100ms, store_, log_};
  std::uint32_t generation_ = 1;
};

TEST_F(StateSaverTest, SavesAtOnceAndThenAtTheMostOnceEveryInterval) {
  EXPECT_FALSE(saver_.is_due(clock_.now())) << "nothing was published";
  EXPECT_EQ(saver_.next_deadline(), port::never);
  for (std::int32_t i = 0; i < 6000; ++i) {
    saver_.mark_dirty();
    ++generation_;
    step(i);
    clock_.pass(100ms);
  }
  EXPECT_EQ(store_.saves, 10u);
  EXPECT_LE(saver_.next_deadline(), clock_.now() + 1min);
}

TEST_F(StateSaverTest, SavesNothingThatIsSavedAlready) {
  for (int i = 0; i < 100; ++i) {
    saver_.mark_dirty();
    step(5);
    clock_.pass(1min);
  }
  EXPECT_EQ(store_.saves, 1u);
  EXPECT_EQ(saver_.next_deadline(), port::never);
}

TEST_F(StateSaverTest, NoGenerationIsGivenOutTwiceWhateverTheMomentOfThePowerFailure) {
  // The mesh goes to and fro, so that what is saved is often what was.
  for (std::int32_t i = 0; i < 20'000; ++i) {
    saver_.mark_dirty();
    ++generation_;
    step(i / 3000 % 2);
    ASSERT_GT(saved().next_generation, generation_);
    clock_.pass(100ms);
  }
  EXPECT_LT(store_.saves, 33u);
}

TEST_F(StateSaverTest, TheLastStateGoesOnWithTheVeryNextGeneration) {
  saver_.mark_dirty();
  step(1);
  generation_ = 5;
  saver_.step(clock_.now());
  saver_.finish();
  step(1);
  EXPECT_EQ(store_.saves, 2u);
  EXPECT_EQ(saved().next_generation, 6u);
  saver_.step(clock_.now());
  saver_.finish();
  step(1);
  EXPECT_EQ(store_.saves, 2u) << "once is enough";
}

TEST_F(StateSaverTest, SaysOnceThatItCannotSaveTriesAgainAndSaysWhenItCan) {
  store_.why = "/state: cannot write the file (No space left on device); make room on that disk";
  for (int i = 0; i < 600; ++i) {
    saver_.mark_dirty();
    step(i);
    clock_.pass(1s);
  }
  EXPECT_EQ(store_.saves, 10u);
  EXPECT_EQ(log_.lines, (std::vector<std::string>{"state is not saved: " + store_.why +
                                                  "; goes on, and tries again"}));
  EXPECT_TRUE(saver_.disk().is_failing());
  store_.why = "/state: cannot write the file (Input/output error); the disk may be failing";
  for (int i = 0; i < 120; ++i, clock_.pass(1s)) step(1);
  EXPECT_EQ(log_.lines.size(), 2u) << "another reason is news";
  store_.why.clear();
  for (int i = 0; i < 120; ++i, clock_.pass(1s)) step(1);
  EXPECT_EQ(log_.lines.back(), "state is saved again");
  EXPECT_EQ(log_.lines.size(), 3u);
  EXPECT_FALSE(saver_.disk().is_failing());
}

TEST_F(StateSaverTest, WaitsForASaveThatTakesLong) {
  store_.is_slow = true;
  for (int i = 0; i < 600; ++i, clock_.pass(1s)) {
    saver_.mark_dirty();
    step(i);
  }
  EXPECT_EQ(store_.saves, 1u);
  store_.is_slow = false;
  step(1);
  step(2);
  EXPECT_EQ(store_.saves, 2u);
}

TEST_F(StateSaverTest, SaysOnceThatTheDiskDoesNotAnswer) {
  store_.is_slow = true;
  for (int i = 0; i < 9; ++i, clock_.pass(1s)) {
    saver_.mark_dirty();
    step(i);
  }
  EXPECT_TRUE(log_.lines.empty()) << "it may be slow";
  for (int i = 0; i < 600; ++i, clock_.pass(1s)) step(i);
  EXPECT_EQ(log_.lines,
            (std::vector<std::string>{
                "state: the disk of `folder` of [state] does not answer, look at it: a restart "
                "would find an earlier state; goes on without"}));
  store_.is_slow = false;
  step(1);
  EXPECT_EQ(log_.lines.back(), "state is saved again");
  EXPECT_EQ(log_.lines.size(), 2u);
  // One that fails after all is not saved.
  clock_.pass(2min);
  store_.is_slow = true;
  saver_.mark_dirty();
  step(700);
  clock_.pass(20s);
  step(700);
  EXPECT_EQ(log_.count("does not answer"), 2u) << "said anew when it comes back";
  store_.is_slow = false;
  store_.why = "/state: cannot write the file (Input/output error); the disk may be failing";
  clock_.pass(2min);
  step(701);
  clock_.pass(2min);
  step(701);
  EXPECT_EQ(log_.count("state is not saved: /state: cannot write"), 1u);
  EXPECT_EQ(log_.count("state is saved again"), 1u);
  store_.why.clear();
  clock_.pass(2min);
  step(702);
  step(702);
  EXPECT_EQ(log_.count("state is saved again"), 2u);
}

TEST_F(StateSaverTest, LoadsTheLastElseThePrevious) {
  EXPECT_FALSE(saver_.load().has_value());
  EXPECT_TRUE(log_.lines.empty());
  store_.last = store_.previous = example();
  ASSERT_TRUE(saver_.load().has_value());
  EXPECT_TRUE(log_.lines.empty());
  store_.last[0] = std::byte{9};
  const auto state = saver_.load();
  ASSERT_TRUE(state.has_value());
  EXPECT_EQ(state->generation, 41u);
  EXPECT_EQ(log_.lines,
            (std::vector<std::string>{
                "state: the last copy is not used, it is from a newer gateway (form 9, this one "
                "knows 6); it is kept as /state/aside-1",
                "state: takes the copy before the last"}));
  EXPECT_EQ(store_.aside.size(), 1u);
}

TEST_F(StateSaverTest, RefusesTheStateOfAnotherConfiguration) {
  StateWriter writer(1000);
  writer.begin(1, 2, 0);
  writer.add_bus("roof");
  const auto bytes = writer.finish();
  store_.last.assign(bytes.begin(), bytes.end());
  EXPECT_FALSE(saver_.load().has_value());
  EXPECT_EQ(log_.lines,
            (std::vector<std::string>{
                "state: the last copy is not used, it is of another configuration, without any bus "
                "of this one (it has roof); it is kept as /state/aside-1"}));
}

}  // namespace
}  // namespace etcm::firmware
