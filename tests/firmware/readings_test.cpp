// What nodes measure, from the registers of devices to the published table.
#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "measuring.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

TEST_F(Measuring, QuantitiesAreThoseOfDevicesWithTheSameNameAndUnit) {
  start();
  EXPECT_EQ(published().quantities,
            (std::vector<Quantity>{{"level", "m"}, {"temperature", "°C"}, {"level", "cm"}}));
  EXPECT_TRUE(published().readings.empty());
}

TEST_F(Measuring, ValuesAreExactAndWithTheirNodes) {
  put_tank(2, 1234);
  put_tank(3, -999);
  put_well(5, 77, 21.5f, 123'456'789);
  put_rover(8, 50, 50, -7);
  start();
  rig_.run(1s);
  EXPECT_EQ(nano(1002), 1'234'000'000);
  EXPECT_EQ(nano(1003), -999'000'000);
  EXPECT_EQ(nano(77), 123'456'789);
  EXPECT_EQ(nano(77, "temperature"), 21'500'000'000);
  EXPECT_EQ(nano(1008), -7'000'000'000);
  ASSERT_EQ(published().readings.size(), 5u);
  for (const PublishedReading& found : published().readings) {
    ASSERT_NE(found.row, no_row);
    EXPECT_EQ(rig_.gateway->snapshot().vertices[found.row].serial, found.serial);
    EXPECT_FALSE(found.is_stale);
    EXPECT_LE(rig_.clock.now() - found.taken_at, 300ms);
  }
  EXPECT_EQ(published().generation, rig_.gateway->generation());
}

TEST_F(Measuring, WhatIsNoValueIsNone) {
  put_tank(2, 32767);   // none
  put_tank(3, 20'001);  // out of range
  put_well(5, 77, std::numeric_limits<float>::quiet_NaN(), 5, false);
  start();
  rig_.run(1s);
  ASSERT_EQ(published().readings.size(), 4u);
  for (const PublishedReading& found : published().readings) {
    EXPECT_FALSE(found.nano.has_value());
    EXPECT_FALSE(found.is_stale);
  }
  put_tank(2, 5);
  rig_.run(500ms);
  EXPECT_EQ(nano(1002), 5'000'000);
  put_tank(2, 32767);
  rig_.run(500ms);
  EXPECT_FALSE(nano(1002).has_value()) << "the last value does not stay";
}

TEST_F(Measuring, AChangedValueMakesNoGeneration) {
  put_tank(2, 1);
  put_tank(3, 2);
  start();
  rig_.run(5s);  // until it is known which devices never answer
  const std::uint32_t generation = rig_.gateway->generation();
  const std::uint32_t sequence = published().sequence;
  for (std::int16_t level = 10; level < 20; ++level) {
    put_tank(2, level);
    const std::uint32_t before = published().value_sequence;
    rig_.run(300ms);
    EXPECT_EQ(nano(1002), level * 1'000'000);
    EXPECT_GT(published().value_sequence, before);
  }
  EXPECT_EQ(rig_.gateway->generation(), generation);
  EXPECT_GE(published().sequence, sequence + 10);
}

TEST_F(Measuring, TheSameValueAgainHasANewTimeOnly) {
  put_tank(2, 1);
  start();
  rig_.run(1s);
  const std::uint32_t sequence = published().sequence;
  const std::uint32_t values = published().value_sequence;
  const port::Instant taken_at = reading(1002, "level")->taken_at;
  rig_.run(1s);
  EXPECT_GT(published().sequence, sequence);
  EXPECT_GT(reading(1002, "level")->taken_at, taken_at);
  EXPECT_EQ(published().value_sequence, values);
}

TEST_F(Measuring, TablesArePublishedNoFasterThanThePause) {
  for (const std::uint8_t unit : {std::uint8_t{2}, std::uint8_t{3}}) put_tank(unit, 1);
  start();
  rig_.run(1s);
  const std::uint32_t sequence = published().sequence;
  rig_.run(10s);
  EXPECT_LE(published().sequence, sequence + 101);
}

TEST_F(Measuring, WhoFallsSilentIsStaleAndMissingAndNeverFresh) {
  put_tank(2, 1234);
  put_tank(3, 1);
  start();
  rig_.run(1s);
  bus_.silence(2);
  rig_.run(1500ms);
  EXPECT_TRUE(is_stale(1002));
  EXPECT_EQ(nano(1002), 1'234'000'000) << "what it was last is still told";
  EXPECT_FALSE(is_stale(1003));
  rig_.run(5s);
  ASSERT_EQ(rig_.gateway->snapshot().missing_count, 1u);
  ASSERT_NE(reading(1002, "level"), nullptr);
  EXPECT_TRUE(is_stale(1002));
  EXPECT_EQ(reading(1002, "level")->row, no_row);
  // Dismissed, it is not known any more.
  EXPECT_TRUE(rig_.gateway->dismiss(Serial{1002}));
  rig_.run(500ms);
  EXPECT_EQ(reading(1002, "level"), nullptr);
  put_tank(2, 7);
  rig_.run(60s);  // it is asked seldom by now
  EXPECT_EQ(nano(1002), 7'000'000);
  EXPECT_FALSE(is_stale(1002));
}

// A device whose blocks are not all answered measures nothing, though a part of it speaks.
TEST_F(Measuring, AnIncompleteSweepMeasuresNothing) {
  put_well(5, 77, 20, 1);
  start();
  rig_.run(1s);
  ASSERT_EQ(nano(77, "temperature"), 20'000'000'000);
  put_well(5, 77, 30, 2);
  bus_.devices[5].erase(21);
  rig_.run(2s);
  EXPECT_EQ(nano(77, "temperature"), 20'000'000'000);
  EXPECT_TRUE(is_stale(77, "temperature"));
}

TEST_F(Measuring, ANodeThatDoesNotKnowWhereItIsMeasures) {
  put_rover(8, 0, 0, 12, false);
  start();
  rig_.run(3s);
  EXPECT_EQ(nano(1008), 12'000'000'000);
  EXPECT_FALSE(is_stale(1008)) << "its place is unknown, not its level";
  EXPECT_EQ(reading(1008, "level")->row, no_row);
}

TEST_F(Measuring, AnAnswerThatIsNotBelievedMeasuresNothing) {
  put_well(5, 77, 20, 1);
  put_well(6, 77, 99, 1);  // says to be the same one
  start();
  rig_.run(2s);
  std::size_t count = 0;
  for (const PublishedReading& found : published().readings) {
    EXPECT_EQ(found.serial, Serial{77});
    if (found.quantity == QuantityIndex{1}) ++count;
  }
  EXPECT_EQ(count, 1u);
}

TEST_F(Measuring, ANodeThatMovesToAnotherUnitTakesItsReadingsAlong) {
  put_well(5, 77, 20, 1);
  start();
  rig_.run(1s);
  bus_.silence(5);
  put_well(6, 77, 25, 2);
  rig_.run(5s);
  ASSERT_EQ(readings_of(published(), Serial{77}).size(), 2u);
  EXPECT_EQ(nano(77, "temperature"), 25'000'000'000);
  EXPECT_FALSE(is_stale(77));
  // Another one where it was.
  put_well(5, 78, 5, 3);
  rig_.run(3s);
  EXPECT_EQ(nano(78, "temperature"), 5'000'000'000);
  EXPECT_EQ(nano(77, "temperature"), 25'000'000'000);
}

TEST_F(Measuring, RowsAreThoseOfTheMeshThatWasPublishedLast) {
  put_tank(2, 1);
  put_tank(3, 2);
  start();
  for (int round = 0; round < 20; ++round) {
    bus_.silence(3);
    rig_.run(round % 2 == 0 ? 5s : 700ms);
    put_tank(3, 3);
    rig_.run(350ms);
    EXPECT_EQ(published().generation, rig_.gateway->generation());
    for (const PublishedReading& found : published().readings) {
      if (found.row == no_row) continue;
      EXPECT_EQ(rig_.gateway->snapshot().vertices.at(found.row).serial, found.serial);
    }
  }
}

// What the writers of files get of a node, by its serial.
std::map<std::string, std::optional<std::int64_t>> values_of(const files::MeshImage& image,
                                                             std::uint32_t serial) {
  std::map<std::string, std::optional<std::int64_t>> found;
  for (std::uint32_t vertex = 0; vertex < image.vertices.size(); ++vertex) {
    std::map<std::string, std::optional<std::int64_t>> values;
    for (const files::ImageValue& value : image.values) {
      if (value.vertex == vertex) values[image.value_names[value.name]] = value.nano;
    }
    const auto told = values.find("serial");
    if (told != values.end() && told->second == serial * nano_per_one) found = values;
  }
  return found;
}

TEST_F(Measuring, FilesHaveWhatNodesMeasureAndFollowIt) {
  using Values = std::map<std::string, std::optional<std::int64_t>>;
  put_tank(2, 1500);
  put_tank(3, 32767);
  start();
  rig_.run(2s);
  EXPECT_EQ(values_of(*rig_.files.last, 1002),
            (Values{{"serial", 1002 * nano_per_one}, {"reading level (m)", 1'500'000'000}}));
  EXPECT_EQ(values_of(*rig_.files.last, 1003),
            (Values{{"serial", 1003 * nano_per_one}, {"reading level (m)", std::nullopt}}));
  rig_.run(3s);  // until it is known which devices never answer
  const std::uint32_t attempts = rig_.files.attempts;
  rig_.run(2s);
  EXPECT_EQ(rig_.files.attempts, attempts) << "the same values are in the files";
  put_tank(2, 1501);
  rig_.run(1s);
  EXPECT_EQ(values_of(*rig_.files.last, 1002).at("reading level (m)"), 1'501'000'000);
  bus_.silence(2);
  rig_.run(2s);
  EXPECT_EQ(values_of(*rig_.files.last, 1002),
            (Values{{"serial", 1002 * nano_per_one}, {"stale reading level (m)", 1'501'000'000}}));
}

TEST_F(Measuring, AReloadThatAsksOftenerMakesNothingFreshAgain) {
  put_tank(2, 1);
  start();
  rig_.run(1s);
  bus_.silence(2);
  rig_.run(1500ms);
  ASSERT_TRUE(is_stale(1002));
  rig_.settings.poll.interval = 50ms;
  rig_.settings.poll.stale_after = 2500ms;
  rig_.update_settings();
  rig_.run(100ms);
  EXPECT_TRUE(is_stale(1002));
}

}  // namespace
}  // namespace etcm::firmware
