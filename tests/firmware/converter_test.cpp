// The default settings behind a converter from Modbus TCP to a serial line: one queue, one line,
// and a unit that does not answer holds it until the converter's own patience is over. Poller and
// bus are real; converter and time are the test's.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

#include "converter_site.h"

namespace etcm::firmware {
namespace {

struct Converter {
  const char* name;
  Behind behind;
};
class BehindAConverter : public testing::TestWithParam<Converter> {};

// Of a line on which nobody is dead, for the time that the dead ones did not hold it.
TEST_P(BehindAConverter, HealthyUnitsLoseNoPolls) {
  const Behind& behind = GetParam().behind;
  ConverterSite site(behind);
  std::vector<UnitRange> healthy;
  for (std::uint8_t unit = 1; unit <= behind.units; ++unit) {
    if (std::find(behind.dead.begin(), behind.dead.end(), unit) == behind.dead.end()) {
      healthy.push_back({unit, unit});
    }
  }
  ConverterSite without(behind, healthy);
  // It finds out whom it can ask, and how.
  for (ConverterSite* const each : {&site, &without}) each->run_for(20s);
  const std::uint32_t before = site.all_readings(), before_without = without.all_readings();
  const std::uint32_t asked_before = site.dead_requests(behind);
  for (ConverterSite* const each : {&site, &without}) each->run_for(600s);
  const double held = (site.dead_requests(behind) - asked_before) *
                      std::chrono::duration<double>(behind.hold).count();
  EXPECT_GE(site.all_readings() - before, (behind.hold > 1s ? 0.98 : 0.99) *
                                              (without.all_readings() - before_without) *
                                              (1 - held / 600));
  EXPECT_LE(held / 600, behind.units == 2 ? 0.12 : 0.04);
  EXPECT_GE(held, behind.dead.empty() ? 0.0 : 2.0) << "they may come back";
}

TEST_P(BehindAConverter, NorDoTheyTimeOutAndNothingPilesUp) {
  const Behind& behind = GetParam().behind;
  ConverterSite site(behind);
  site.run_for(60s);
  EXPECT_LE(site.timeouts_of_healthy(behind), 4u) << site.logged();
  EXPECT_LE(site.device.longest_queue, 6u);
  for (std::uint8_t unit = 1; unit <= behind.units; ++unit) {
    const bool is_dead =
        std::find(behind.dead.begin(), behind.dead.end(), unit) != behind.dead.end();
    EXPECT_EQ(site.readings[unit] > 0, !is_dead) << "unit " << int{unit};
  }
}

INSTANTIATE_TEST_SUITE_P(
    Rows, BehindAConverter,
    testing::Values(Converter{"one_dead", {.units = 21, .dead = {11}}},
                    Converter{"first_dead", {.units = 21, .dead = {1}}},
                    Converter{"last_dead", {.units = 21, .dead = {21}}},
                    Converter{"path_unavailable", {.units = 21, .dead = {11}, .exception = 0x0a}},
                    Converter{"says_nothing", {.units = 21, .dead = {11}, .exception = 0}},
                    Converter{"short_hold", {.units = 21, .dead = {11}, .hold = 300ms}},
                    Converter{"long_hold", {.units = 21, .dead = {11}, .hold = 3s}},
                    Converter{"three_dead", {.units = 23, .dead = {1, 2, 20}}},
                    Converter{"one_unit_and_a_dead_one", {.units = 2, .dead = {1}}},
                    Converter{"all_at_9600_baud", {.units = 60, .exchange = 50400us}},
                    Converter{"some_dead_at_9600_baud",
                              {.units = 60, .dead = {3, 30}, .exchange = 50400us}},
                    Converter{"all_at_1200_baud", {.units = 60, .exchange = 403ms}}),
    [](const auto& row) { return std::string(row.param.name); });

TEST(Converter, IsSaidOnceWithWhatToSet) {
  ConverterSite site({.units = 21, .dead = {21}});
  site.run_for(300s);
  ASSERT_EQ(site.log.lines.size(), 2u) << site.logged();
  const std::string& line = site.log.lines.back();
  EXPECT_EQ(line.find("bus yard: unit 21 was answered for too late, after 1000 ms"), 0u) << line;
  EXPECT_NE(line.find("set outstanding = 1, and [[bus.device]] with units = \"21\" and timeout = "
                      "\"1300ms\""),
            std::string::npos)
      << line;
}

TEST(Converter, IsSaidAgainWhileItGoesOn) {
  ConverterSite site({.units = 21, .dead = {21}});
  site.run_for(59min);
  EXPECT_EQ(site.log.count("answered for too late"), 1u) << site.logged();
  site.run_for(5h);
  EXPECT_EQ(site.log.count("answered for too late"), 6u) << site.logged();
}

TEST(Converter, ALineThatWasOutIsBackWithinTwoPolls) {
  ConverterSite site({.units = 20});
  site.run_for(20s);
  site.device.fall_silent(true);
  site.run_for(60s);
  site.device.fall_silent(false);
  site.run_for(1s);  // that is when it answers for the last question
  const std::vector<std::uint32_t> before = site.readings;
  site.run_for(2s);
  for (std::uint8_t unit = 1; unit <= 20; ++unit) {
    EXPECT_GT(site.readings[unit], before[unit]) << "unit " << int{unit};
  }
}

// Nobody answers, and nobody says so: each is asked in its time.
// They are no reason to mistrust the connection, nor to let the one that is there wait.
// Connections that the gateway gives up itself are no unit's fault.
TEST(Converter, ALineThatWasOutForMinutesIsBackWithinOne) {
  for (const bool is_one_line : {false, true}) {
    ConverterSite site({.exception = 0, .is_one_line = is_one_line});
    site.run_for(20s);
    site.device.fall_silent(true);
    site.run_for(600s);
    site.device.fall_silent(false);
    const std::vector<std::uint32_t> before = site.readings;
    site.run_for(60s);
    for (std::uint8_t unit = 1; unit <= 20; ++unit) {
      EXPECT_GT(site.readings[unit], before[unit]) << "unit " << int{unit} << ' ' << is_one_line;
    }
  }
}

// Some do so for a unit that does not answer, or for a question that they do not understand.
class ThatEndsItsConnection : public testing::TestWithParam<bool> {
 protected:
  Behind behind_{.is_one_line = GetParam(), .ends_for = {7}};
};

TEST_P(ThatEndsItsConnection, ForAUnitDoesNotKeepTheOthersFromBeingHeard) {
  ConverterSite site(behind_);
  site.run_for(60s);
  const std::uint32_t before = site.all_readings(), ends_before = site.device.ends;
  site.run_for(600s);
  // It is asked as one that is dead, each 10 s, and there is another connection at once.
  EXPECT_LE(site.device.ends - ends_before, 75u);
  EXPECT_GE(site.device.ends - ends_before, 30u) << "it may be well again";
  EXPECT_GE(site.all_readings() - before, 19u * 600 * 95 / 100);
  for (std::uint8_t unit = 1; unit <= behind_.units; ++unit) {
    if (unit == 7) continue;
    const std::vector<port::Instant>& at = site.read_at[unit];
    for (std::size_t i = 1; i < at.size(); ++i) EXPECT_LE(at[i] - at[i - 1], 4s) << int{unit};
  }
}

// It is made anew once in a second at the most, and they are asked more often.
TEST_P(ThatEndsItsConnection, ForManyUnitsCostsTheOthersAThirtiethOfTheirTime) {
  behind_.units = 60;
  behind_.ends_for.resize(30);
  std::iota(behind_.ends_for.begin(), behind_.ends_for.end(), std::uint8_t{31});
  behind_.exchange = 10ms;
  ConverterSite site(behind_);
  site.run_for(200s);
  const std::uint32_t before = site.all_readings();
  site.run_for(600s);
  EXPECT_GE(site.all_readings() - before, 30u * 600 * 95 / 100);
  for (std::uint8_t unit = 31; unit <= 60; ++unit) EXPECT_GE(site.device.requests[unit], 3u);
}

TEST_P(ThatEndsItsConnection, ForAUnitIsSaidOnceWithItsName) {
  ConverterSite site(behind_);
  site.run_for(120s);
  unsigned said = 0;
  for (const std::string& line : site.log.lines) {
    said += line.find("unit 7 of yard: the connection ends each time it is asked") == 0;
    EXPECT_TRUE(line.find("unit ") != 0 || line.find("unit 7 ") == 0) << line;
  }
  EXPECT_EQ(said, 1u) << site.logged();
}

// Then it is no unit's fault.
TEST_P(ThatEndsItsConnection, ForWhomeverItIsAskedIsHeldAgainstNobody) {
  behind_.ends_for.resize(behind_.units);
  std::iota(behind_.ends_for.begin(), behind_.ends_for.end(), std::uint8_t{1});
  ConverterSite site(behind_);
  site.run_for(120s);
  EXPECT_GE(site.device.ends, 60u);
  for (const std::string& line : site.log.lines) EXPECT_NE(line.find("unit "), 0u) << line;
}

TEST_P(ThatEndsItsConnection, NowAndThenIsHeldAgainstNobody) {
  behind_.ends_for.clear();
  ConverterSite site(behind_);
  for (int minute = 0; minute < 20; ++minute) {
    site.run_for(30s + minute * 700ms);
    site.device.end();
  }
  EXPECT_EQ(site.device.ends, 20u);
  for (const std::string& line : site.log.lines) EXPECT_NE(line.find("unit "), 0u) << line;
}

INSTANTIATE_TEST_SUITE_P(Rows, ThatEndsItsConnection, testing::Bool(),
                         [](const testing::TestParamInfo<bool>& row) {
                           return row.param ? "OneLine" : "BesideEachOther";
                         });

TEST(UnitsBesideEachOther, AreHeardSoonAfterAStartWithManyThatAreNotThere) {
  for (std::uint8_t alive = 1; alive <= 12; ++alive) {
    Behind behind{.units = 12, .exchange = 30ms, .hold = 1s, .exception = 0, .is_one_line = false};
    for (std::uint8_t unit = 1; unit <= 12; ++unit) {
      if (unit != alive) behind.dead.push_back(unit);
    }
    ConverterSite site(behind);
    site.run_for(3s);
    EXPECT_GE(site.readings[alive], 1u) << int{alive};
    site.run_for(57s);
    EXPECT_GE(site.readings[alive], 57u) << int{alive};
    EXPECT_EQ(site.logged().find("nothing answers"), std::string::npos) << site.logged();
  }
}

TEST(UnitsBesideEachOther, ThatAreAllNotThereAreSaidToBe) {
  ConverterSite site(
      {.units = 3, .dead = {1, 2, 3}, .hold = 1s, .exception = 0, .is_one_line = false});
  site.run_for(20s);
  EXPECT_NE(site.logged().find("nothing answers"), std::string::npos) << site.logged();
}

TEST(UnitsBesideEachOther, AreFoundAmongManyThatAreNotThere) {
  ConverterSite site({.units = 0, .hold = 1h, .exception = 0, .is_one_line = false}, {{1, 247}});
  site.run_for(25s);
  for (std::uint8_t unit = 1; unit <= 247; ++unit) EXPECT_GE(site.device.requests[unit], 1u);
}

TEST(UnitsBesideEachOther, AreAskedBesideEachOther) {
  // Each takes 150 ms; four at a time are 26 a second, of 30 that are due.
  const Behind behind{.units = 30,
                      .dead = {7},
                      .exchange = 150ms,
                      .hold = 1h,
                      .exception = 0,
                      .is_one_line = false};
  ConverterSite site(behind);
  site.run_for(20s);
  const std::uint32_t before = site.all_readings();
  site.run_for(100s);
  EXPECT_GE(site.all_readings() - before, 2500u);
}

TEST(UnitsBesideEachOther, AreWaitedForAsLongAsTheyNeed) {
  ConverterSite site({.units = 4, .exchange = 350ms, .is_one_line = false});
  site.run_for(20s);
  const std::vector<std::uint32_t> before = site.readings;
  site.run_for(60s);
  for (std::uint8_t unit = 1; unit <= 4; ++unit) EXPECT_GE(site.readings[unit] - before[unit], 58u);
  EXPECT_GE(site.log.count("was answered for too late, after 350 ms"), 3u) << site.logged();
}

}  // namespace
}  // namespace etcm::firmware
