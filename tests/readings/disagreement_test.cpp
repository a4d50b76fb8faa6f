// Which sensors are said to disagree, on simulated sites. One sample is one minute.
#include "firmware/readings/disagreement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "moving_field.h"
#include "simulated_site.h"
#include "support/allocation_watch.h"
#include "support/emulated.h"

namespace etcm::firmware {
namespace {

constexpr int minutes_of_a_year = 365 * 24 * 60;
constexpr int learned_after = 400;
constexpr double drift = 0.05;
constexpr int found_within = 10;

class WatchedSite {
 public:
  WatchedSite(const std::vector<Position>& positions, const test::FieldManner& manner,
              std::uint64_t seed)
      : snapshot_(test::snapshot_of({"", positions, {}})),
        nodes_(row_count(), row_count()),
        field_(snapshot_, manner, seed),
        watch_(taken(nodes_, snapshot_), row_count(), row_count()),
        disagreed_(row_count()) {
    take(snapshot_);
  }

  std::uint32_t row_count() const { return static_cast<std::uint32_t>(snapshot_.vertices.size()); }
  const Agreement& of(std::uint32_t row) const { return watch_.of(row); }
  DisagreementWatch& watch() { return watch_; }
  void take(const Snapshot& snapshot) {
    watch_.take(snapshot, test::sensors_in(test::rows_of(snapshot)));
  }
  const Snapshot& snapshot() const { return snapshot_; }
  int begun_alarms() const { return begun_alarms_; }

  using Spoil = std::function<void(std::vector<double>& values, int sample)>;

  // Spoils each sample from 0 on; it is seen as spoiled.
  void run(int samples, const Spoil& spoil = {}) {
    for (int sample = 0; sample < samples; ++sample) {
      auto& values = field_.next();
      if (spoil) spoil(values, sample);
      watch_.observe(values);
      for (std::uint32_t row = 0; row < row_count(); ++row) {
        const bool disagrees = of(row).disagrees;
        if (disagrees && !disagreed_[row]) ++begun_alarms_;
        disagreed_[row] = disagrees;
      }
    }
  }

  // Samples until the alarm of a row begins; 0: not within so many.
  int samples_until_alarm(std::uint32_t row, int samples_max, const Spoil& spoil) {
    for (int sample = 0; sample < samples_max; ++sample) {
      run(1, [&](std::vector<double>& values, int) { spoil(values, sample); });
      if (of(row).disagrees) return sample + 1;
    }
    return 0;
  }

  // In the middle of the site, and at its hull.
  std::uint32_t inner_row() const {
    std::uint32_t best = 0;
    double least = 1e300;
    for (std::uint32_t row = 0; row < row_count(); ++row) {
      const double away =
          std::hypot(test::x_of(snapshot_, row) - 5e5, test::y_of(snapshot_, row) - 5e5);
      if (away < least) best = row;
      least = std::min(least, away);
    }
    return best;
  }
  std::uint32_t hull_row() const {
    std::uint32_t best = 0;
    for (std::uint32_t row = 0; row < row_count(); ++row) {
      if (test::x_of(snapshot_, row) < test::x_of(snapshot_, best)) best = row;
    }
    return best;
  }

 private:
  static const NearestNodes& taken(NearestNodes& nodes, const Snapshot& snapshot) {
    nodes.take(snapshot, test::rows_of(snapshot));
    return nodes;
  }

  Snapshot snapshot_;
  NearestNodes nodes_;
  test::MovingField field_;
  DisagreementWatch watch_;
  std::vector<bool> disagreed_;
  int begun_alarms_ = 0;
};

std::vector<Position> hundred_nodes(std::uint64_t seed) {
  return test::scattered(100, 1'000'000, seed);
}

constexpr test::FieldManner calm{.noise = 0.01, .shape_swing = 0.05};

WatchedSite::Spoil offset_of(std::uint32_t row, double offset) {
  return [=](std::vector<double>& values, int) { values[row] += offset; };
}

TEST(Disagreement, OfFivePercentIsFoundWithinTenSamples) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    for (std::uint32_t row = 0; row < 100; row += 7u * test::thinning_if_slow) {
      WatchedSite site(hundred_nodes(seed), calm, 100 * seed + row);
      site.run(learned_after);
      const int samples = site.samples_until_alarm(row, found_within,
                                                   offset_of(row, row % 2 == 0 ? drift : -drift));
      EXPECT_GT(samples, 0) << "row " << row << ", seed " << seed;
      // A few wild readings are no disagreement yet.
      EXPECT_FALSE(samples > 0 && samples < 4) << samples;
      site.run(60, offset_of(row, row % 2 == 0 ? drift : -drift));
      EXPECT_EQ(site.begun_alarms(), 1) << "row " << row << ", seed " << seed;
    }
  }
}

// Sparse sites, lively fields and noise of any size.
TEST(Disagreement, OfSoundSensorsIsRarerThanOncePerNodeYear) {
  const struct {
    std::size_t nodes;
    double noise, swing;
  } families[] = {{100, 0.01, 0.05}, {100, 0.02, 0.05}, {100, 0.001, 0.1}, {100, 0.01, 0.1},
                  {50, 0.001, 0.1},  {50, 0.01, 0.1},   {50, 0.02, 0.1}};
  double all_years = 0;
  int all_alarms = 0;
  for (const auto& [nodes, noise, swing] : families) {
    double node_years = 0;
    int alarms = 0;
    for (std::uint64_t seed = 41; seed <= 43; ++seed) {
      const int samples = 7000 / test::thinning_if_slow;
      WatchedSite site(test::scattered(nodes, 1'000'000, seed),
                       {.noise = noise, .shape_swing = swing}, seed);
      site.run(samples);
      node_years += static_cast<double>(nodes) * samples / minutes_of_a_year;
      alarms += site.begun_alarms();
    }
    EXPECT_LE(alarms, std::ceil(node_years)) << nodes << " nodes, noise " << noise;
    all_years += node_years;
    all_alarms += alarms;
  }
  EXPECT_LE(all_alarms, std::max(1.0, all_years / 2));
}

// Of all sensors of some sites, how many in a hundred with an offset of 5 % are found in ten
// samples.
TEST(Disagreement, OfFivePercentIsFoundInNoiseOfTwo) {
  const struct {
    std::size_t nodes;
    double swing;
    int percent;
  } families[] = {{100, 0.05, 80}, {100, 0.1, 70}, {50, 0.1, 60}};
  for (const auto& [nodes, swing, percent] : families) {
    int tried = 0, found = 0;
    for (std::uint64_t seed = 51; seed <= 54; ++seed) {
      for (std::uint32_t row = 0; row < nodes; row += 5u * test::thinning_if_slow) {
        WatchedSite site(test::scattered(nodes, 1'000'000, seed),
                         {.noise = 0.02, .shape_swing = swing}, 100 * seed + row);
        site.run(learned_after);
        ++tried;
        found += site.samples_until_alarm(row, found_within, offset_of(row, drift)) > 0 ? 1 : 0;
      }
    }
    EXPECT_GE(100 * found, percent * tried) << nodes << " nodes, " << found << " of " << tried;
  }
}

TEST(Disagreement, IsFoundInAnyNoise) {
  const struct {
    double noise;
    int within;
  } cases[] = {{0.0, 10}, {0.001, 10}, {0.003, 10}, {0.01, 10}, {0.02, 25}};
  for (const auto& [noise, within] : cases) {
    WatchedSite site(hundred_nodes(5), {.noise = noise, .shape_swing = 0.05}, 5);
    site.run(learned_after);
    const std::uint32_t row = site.inner_row();
    EXPECT_GT(site.samples_until_alarm(row, within, offset_of(row, drift)), 0) << noise;
    site.run(200, offset_of(row, drift));
    EXPECT_EQ(site.begun_alarms(), 1) << noise;
  }
}

TEST(Disagreement, IsFoundAtTheHull) {
  WatchedSite site(hundred_nodes(6), calm, 6);
  site.run(learned_after);
  const std::uint32_t row = site.hull_row();
  EXPECT_GT(site.samples_until_alarm(row, found_within, offset_of(row, drift)), 0);
  EXPECT_EQ(site.begun_alarms(), 1);
}

// However slow it is: a reference follows by 2 % and no farther.
TEST(Disagreement, OfASlowRampIsFoundBeforeItIsLarge) {
  for (const int days : {1, 3}) {
    WatchedSite site(hundred_nodes(7), calm, 7);
    site.run(learned_after);
    const std::uint32_t row = site.inner_row();
    const int whole = days * 1440;
    const int samples =
        site.samples_until_alarm(row, whole, [&](std::vector<double>& values, int sample) {
          values[row] += 1.2 * drift * sample / whole;
        });
    EXPECT_GT(samples, 0) << days;
    EXPECT_EQ(site.begun_alarms(), 1) << days;
    // Neighbours have followed some of it, and are none the worse when it is found.
    site.run(300, offset_of(row, 1.2 * drift));
    EXPECT_EQ(site.begun_alarms(), 1) << days;
  }
}

TEST(Disagreement, OfASensorThatIsStuckIsFoundOnceTheFieldHasMoved) {
  WatchedSite site(hundred_nodes(8), calm, 8);
  site.run(learned_after);
  const std::uint32_t row = site.inner_row();
  double stuck = 0;
  site.run(1, [&](std::vector<double>& values, int) { stuck = values[row]; });
  const int samples = site.samples_until_alarm(
      row, 720, [&](std::vector<double>& values, int) { values[row] = stuck; });
  EXPECT_GT(samples, 0);
  EXPECT_EQ(site.begun_alarms(), 1);
}

TEST(Disagreement, EndsOnceTheSensorAgreesAgain) {
  WatchedSite site(hundred_nodes(9), calm, 9);
  site.run(learned_after);
  const std::uint32_t row = site.inner_row();
  for (const double offset : {drift, -1e9, 20 * drift}) {
    site.run(60, offset_of(row, offset));
    EXPECT_TRUE(site.of(row).disagrees) << offset;
    EXPECT_NEAR(*site.of(row).expected, 0, 3);
    site.run(40);
    EXPECT_FALSE(site.of(row).disagrees) << offset;
  }
  EXPECT_EQ(site.begun_alarms(), 3);
}

// At the corner of a sparse site the field comes and goes so.
TEST(Disagreement, ThatComesAndGoesIsToldAFewTimes) {
  WatchedSite site(hundred_nodes(9), calm, 9);
  site.run(learned_after);
  const std::uint32_t row = site.inner_row();
  for (int day = 0; day < 30; ++day) {
    site.run(30, offset_of(row, drift));
    site.run(90);
  }
  EXPECT_GE(site.begun_alarms(), 2);
  EXPECT_LE(site.begun_alarms(), 2 + ended_alarms_max);
  EXPECT_GT(site.samples_until_alarm(row, found_within, offset_of(row, 5 * drift)), 0);
  site.watch().forget(row);
  site.run(60);
  site.run(learned_after);
  EXPECT_GT(site.samples_until_alarm(row, found_within, offset_of(row, drift)), 0);
}

TEST(Disagreement, OfAWildSensorLeavesItsNeighboursAlone) {
  for (const double offset : {0.5, 100.0, -1e12, 1e90}) {
    WatchedSite site(hundred_nodes(10), calm, 10);
    site.run(learned_after);
    const std::uint32_t row = site.inner_row();
    site.run(200, offset_of(row, offset));
    EXPECT_TRUE(site.of(row).disagrees) << offset;
    EXPECT_EQ(site.begun_alarms(), 1) << offset;
  }
}

TEST(Disagreement, OfTwoNeighboursIsFoundOfBoth) {
  WatchedSite site(hundred_nodes(11), calm, 11);
  site.run(learned_after);
  const std::uint32_t row = site.inner_row();
  NearestNodes nodes(site.row_count(), site.row_count());
  nodes.take(site.snapshot(), test::rows_of(site.snapshot()));
  const std::uint32_t other = nodes.around(row)[0].row;
  site.run(60, [&](std::vector<double>& values, int) {
    values[row] += 2 * drift;
    values[other] += 2 * drift;
  });
  EXPECT_TRUE(site.of(row).disagrees);
  EXPECT_TRUE(site.of(other).disagrees);
  EXPECT_EQ(site.begun_alarms(), 2);
}

// What all do is no disagreement: a jump, a ramp, a tilt, however large.
TEST(Disagreement, IsNotWhatTheWholeFieldDoes) {
  WatchedSite site(hundred_nodes(12), calm, 12);
  site.run(learned_after);
  const auto tilt = [&](std::uint32_t row) { return test::x_of(site.snapshot(), row) / 1e6; };
  site.run(600, [&](std::vector<double>& values, int sample) {
    for (std::uint32_t row = 0; row < values.size(); ++row) {
      values[row] += (sample > 100 ? 50.0 : 0.0) + 0.1 * sample * tilt(row);
    }
  });
  EXPECT_EQ(site.begun_alarms(), 0);
}

// Twice the nodes it takes to see its shape: a front as wide as a fifth of the site.
TEST(Disagreement, IsNotAFrontThatPasses) {
  for (const int samples : {5, 10, 20}) {
    for (std::uint64_t seed = 13; seed < 16; ++seed) {
      test::FieldManner manner = calm;
      manner.front_step = 0.5;
      manner.front_samples = samples;
      manner.front_at = learned_after + 50;
      WatchedSite site(hundred_nodes(seed), manner, seed);
      site.run(learned_after + 200);
      EXPECT_EQ(site.begun_alarms(), 0) << samples << ", seed " << seed;
    }
  }
}

TEST(Disagreement, IsFoundAmongDeadNeighbours) {
  WatchedSite site(hundred_nodes(16), calm, 16);
  site.run(learned_after);
  const std::uint32_t bad = site.inner_row();
  const auto kill = [&](std::vector<double>& values, int sample) {
    for (std::uint32_t row = 0; row < values.size(); ++row) {
      const bool is_silent = row % 3 == 0 || (row + static_cast<std::uint32_t>(sample)) % 10 == 0;
      if (row != bad && is_silent) values[row] = test::no_value;
    }
  };
  site.run(1000, kill);
  EXPECT_EQ(site.begun_alarms(), 0);
  EXPECT_GT(site.samples_until_alarm(bad, 15,
                                     [&](std::vector<double>& values, int sample) {
                                       kill(values, sample);
                                       values[bad] += drift;
                                     }),
            0);
  // Without neighbours nobody can say that it agrees; nor is anybody else accused.
  site.run(100, [&](std::vector<double>& values, int) {
    for (std::uint32_t row = 0; row < values.size(); ++row) {
      if (row != bad) values[row] = test::no_value;
    }
  });
  EXPECT_TRUE(site.of(bad).disagrees);
  EXPECT_FALSE(site.of(bad).is_judged);
  EXPECT_FALSE(site.of(bad).expected);
  site.run(60);
  EXPECT_FALSE(site.of(bad).disagrees);
  EXPECT_EQ(site.begun_alarms(), 1);
}

// Of four nodes each is predicted by a plane through three, and which of them is wrong nobody can
// tell. Of six one can.
TEST(Disagreement, OfFourNodesIsNobodys) {
  WatchedSite four({{0, 0}, {1'000'000, 0}, {0, 1'000'000}, {1'000'000, 1'100'000}}, calm, 17);
  four.run(learned_after);
  four.run(200, offset_of(2, 10));
  EXPECT_EQ(four.begun_alarms(), 0);
  EXPECT_FALSE(four.of(2).is_judged);
  WatchedSite two({{0, 0}, {1'000'000, 0}}, calm, 17);
  two.run(learned_after + 200, offset_of(1, 10));
  EXPECT_EQ(two.begun_alarms(), 0);

  WatchedSite seven({{0, 0},
                     {1'000'000, 0},
                     {0, 1'000'000},
                     {1'000'000, 1'100'000},
                     {500'000, 450'000},
                     {480'000, 900'000},
                     {520'000, 80'000}},
                    {.noise = 0.005, .shape_swing = 0}, 17);
  seven.run(learned_after);
  seven.run(60, offset_of(4, 0.3));
  EXPECT_TRUE(seven.of(4).disagrees);
  EXPECT_EQ(seven.begun_alarms(), 1);
}

TEST(Disagreement, OfEqualReadingsWithoutNoiseIsNone) {
  for (const double reading : {0.0, 21.5, -3e7}) {
    WatchedSite site(hundred_nodes(18), calm, 18);
    const auto level = [&](std::vector<double>& values, int) {
      std::fill(values.begin(), values.end(), reading);
    };
    site.run(learned_after, level);
    EXPECT_EQ(site.begun_alarms(), 0) << reading;
    for (std::uint32_t row = 0; row < site.row_count(); ++row) {
      EXPECT_EQ(site.of(row).expected, reading);
      EXPECT_TRUE(std::isfinite(site.of(row).deviation));
    }
    const std::uint32_t bad = site.inner_row();
    EXPECT_GT(site.samples_until_alarm(bad, found_within,
                                       [&](std::vector<double>& values, int sample) {
                                         level(values, sample);
                                         values[bad] += 1;
                                       }),
              0)
        << reading;
    EXPECT_EQ(site.begun_alarms(), 1) << reading;
  }
}

TEST(Disagreement, OfLessThanTheToleranceIsNone) {
  const Snapshot snapshot = test::snapshot_of({"", hundred_nodes(19), {}});
  NearestNodes nodes(100, 100);
  nodes.take(snapshot, test::rows_of(snapshot));
  DisagreementWatch watch(nodes, 100, 100, 0.1);
  watch.take(snapshot, test::sensors_in(test::rows_of(snapshot)));
  std::vector<double> values(100, 20.0);
  for (int sample = 0; sample < learned_after; ++sample) watch.observe(values);
  values[50] = 20.1;
  for (int sample = 0; sample < learned_after; ++sample) watch.observe(values);
  EXPECT_FALSE(watch.of(50).disagrees);
  values[50] = 20.5;
  for (int sample = 0; sample < found_within; ++sample) watch.observe(values);
  EXPECT_TRUE(watch.of(50).disagrees);
}

TEST(Disagreement, IsNeverMadeOfWhatIsNoNumber) {
  WatchedSite site(hundred_nodes(20), calm, 20);
  const double hostile[] = {test::no_value,
                            std::numeric_limits<double>::infinity(),
                            -std::numeric_limits<double>::infinity(),
                            1.7e308,
                            -1.7e308,
                            1e101};
  std::uint32_t chance = 1;
  const auto spoil = [&](std::vector<double>& values, int) {
    for (double& value : values) {
      chance = chance * 1664525u + 1013904223u;
      if ((chance >> 24) < 40) value = hostile[(chance >> 8) % 6];
    }
  };
  site.run(2 * learned_after, spoil);
  EXPECT_EQ(site.begun_alarms(), 0);
  for (std::uint32_t row = 0; row < site.row_count(); ++row) {
    ASSERT_TRUE(site.of(row).expected) << row;
    EXPECT_NEAR(*site.of(row).expected, 0.5, 3);
    EXPECT_TRUE(std::isfinite(site.of(row).deviation));
    EXPECT_TRUE(std::isfinite(site.of(row).suspicion));
  }
  // A list that is too short, or too long, is no trouble either.
  site.watch().observe({});
  site.watch().observe(std::vector<double>(1000, 1.0));
}

// A constant offset from its neighbours, of any size, is how a place is, not how a sensor is.
TEST(Disagreement, IsNotAnOffsetThatWasThereFromTheFirst) {
  WatchedSite site(hundred_nodes(21), calm, 21);
  const auto offsets = [](std::vector<double>& values, int) {
    for (std::size_t row = 0; row < values.size(); row += 5)
      values[row] += row % 2 == 0 ? 7.0 : -14.0;
  };
  site.run(2 * learned_after, offsets);
  EXPECT_EQ(site.begun_alarms(), 0);
}

TEST(Disagreement, BeginsAnewForAnotherNode) {
  WatchedSite site(hundred_nodes(22), calm, 22);
  const std::uint32_t row = site.inner_row();
  site.run(learned_after);
  site.run(60, offset_of(row, 1));
  ASSERT_TRUE(site.of(row).disagrees);
  site.take(site.snapshot());
  EXPECT_TRUE(site.of(row).disagrees);
  Snapshot other = site.snapshot();
  other.vertices[row].serial = Serial{4711};
  site.take(other);
  EXPECT_FALSE(site.of(row).disagrees);
  EXPECT_FALSE(site.of(row).is_judged);
  site.run(learned_after, offset_of(row, 1));
  EXPECT_FALSE(site.of(row).disagrees);
  EXPECT_TRUE(site.of(row).is_judged);
  site.watch().forget(row);
  EXPECT_FALSE(site.of(row).is_judged);
  site.run(learned_after);
  EXPECT_TRUE(site.of(row).is_judged);
  EXPECT_EQ(site.begun_alarms(), 1);
  // A few units are jitter; a step to where the next one stands is another place.
  other.vertices[row].point.x += 5 * subunits_per_unit;
  site.take(other);
  EXPECT_TRUE(site.of(row).is_judged);
  other.vertices[row].point.x += 100'000 * subunits_per_unit;
  site.take(other);
  EXPECT_FALSE(site.of(row).is_judged);
  site.take(Snapshot{});
  site.run(10);
  EXPECT_EQ(site.begun_alarms(), 1);
}

// A watch that goes on with what another one learned is as good as that.
TEST(Disagreement, IsFoundByWhatWasLearnedBefore) {
  WatchedSite site(hundred_nodes(25), calm, 25);
  const std::uint32_t row = site.inner_row();
  const std::uint32_t wrong = site.hull_row();
  site.run(learned_after);
  site.run(found_within, offset_of(wrong, drift));
  ASSERT_TRUE(site.of(wrong).disagrees);
  std::vector<LearnedSensor> learned;
  site.watch().for_each_learned([&](const LearnedSensor& each) { learned.push_back(each); });
  ASSERT_EQ(learned.size(), 100u);
  site.take(Snapshot{});
  site.take(site.snapshot());
  EXPECT_FALSE(site.of(wrong).disagrees);
  for (const LearnedSensor& each : learned) {
    EXPECT_TRUE(site.watch().restore(each.serial.value - 1000, each));
  }
  EXPECT_TRUE(site.of(wrong).disagrees) << "the alarm stands";
  site.run(1, offset_of(wrong, drift));
  EXPECT_TRUE(site.of(row).is_judged);
  EXPECT_GT(site.samples_until_alarm(row, found_within,
                                     [&](std::vector<double>& values, int) {
                                       values[row] += drift;
                                       values[wrong] += drift;
                                     }),
            0);
  site.run(60);
  EXPECT_FALSE(site.of(row).disagrees);
  EXPECT_FALSE(site.of(wrong).disagrees);
}

// What it knows of the noise and of how each sensor wanders is as it was.
TEST(Disagreement, GoesOnInNoiseAsIfItHadNotStopped) {
  constexpr test::FieldManner noisy = {.noise = 0.03, .shape_swing = 0.05};
  WatchedSite site(hundred_nodes(27), noisy, 27);
  WatchedSite same(hundred_nodes(27), noisy, 27);
  const auto learned_by = [](WatchedSite& each) {
    std::vector<LearnedSensor> learned;
    each.watch().for_each_learned([&](const LearnedSensor& one) { learned.push_back(one); });
    return learned;
  };
  site.run(learned_after);
  same.run(learned_after);
  const auto learned = learned_by(site);
  ASSERT_EQ(learned.size(), 100u);
  for (const LearnedSensor& each : learned) {
    EXPECT_TRUE(each.is_noisy);
    EXPECT_EQ(each.step_count, learned_after - 1u);
    EXPECT_GT(each.wander, 0);
    EXPECT_GT(each.wander_count, learning_samples);
  }
  site.take(Snapshot{});
  site.take(site.snapshot());
  for (const LearnedSensor& each : learned) {
    EXPECT_TRUE(site.watch().restore(each.serial.value - 1000, each));
  }
  EXPECT_EQ(learned_by(site), learned);
  site.run(1);
  same.run(1);
  for (std::uint32_t row = 0; row < 100; ++row) {
    EXPECT_TRUE(site.of(row).is_judged);
    EXPECT_NEAR(site.of(row).deviation, same.of(row).deviation, 0.02 * same.of(row).deviation);
    EXPECT_NEAR(*site.of(row).expected, *same.of(row).expected, 1e-6);
  }
  site.run(1000);
  EXPECT_EQ(site.begun_alarms(), 0);
}

TEST(Disagreement, TakesNothingFromBeforeThatMakesNoSense) {
  WatchedSite site(hundred_nodes(26), calm, 26);
  site.run(10);
  std::vector<LearnedSensor> learned;
  site.watch().for_each_learned([&](const LearnedSensor& each) { learned.push_back(each); });
  const LearnedSensor good = learned.front();
  const std::uint32_t row = good.serial.value - 1000;
  EXPECT_FALSE(site.watch().restore(row, good)) << "something is known already";
  site.watch().forget(row);
  const auto is_taken = [&](auto change) {
    LearnedSensor bad = good;
    change(bad);
    site.watch().forget(row);
    return site.watch().restore(row, bad);
  };
  constexpr double infinity = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(is_taken([](LearnedSensor&) {}));
  EXPECT_FALSE(is_taken([](LearnedSensor& bad) { bad.serial = Serial{4711}; }));
  EXPECT_FALSE(is_taken([](LearnedSensor& bad) { ++bad.definition; }));
  EXPECT_FALSE(is_taken([](LearnedSensor& bad) { bad.point.x += 200'000 * subunits_per_unit; }));
  EXPECT_FALSE(is_taken([](LearnedSensor& bad) { bad.reference = 1e200; }));
  EXPECT_FALSE(is_taken([](LearnedSensor& bad) { bad.followed = test::no_value; }));
  EXPECT_FALSE(is_taken([](LearnedSensor& bad) { bad.slow_change = -infinity; }));
  EXPECT_FALSE(is_taken([](LearnedSensor& bad) { bad.residual = -1; }));
  EXPECT_FALSE(is_taken([](LearnedSensor& bad) { bad.residual_count = 0; }));
  EXPECT_FALSE(is_taken([](LearnedSensor& bad) { bad.roughness = infinity; }));
  EXPECT_FALSE(is_taken([](LearnedSensor& bad) { bad.step = -1; }));
  EXPECT_FALSE(is_taken([](LearnedSensor& bad) { bad.slow_residual = test::no_value; }));
  EXPECT_FALSE(is_taken([](LearnedSensor& bad) { bad.wander = 1e101; }));
  EXPECT_FALSE(is_taken([](LearnedSensor& bad) { bad.wander = -1; }));
  EXPECT_FALSE(is_taken([](LearnedSensor& bad) { bad.wander_count = 0; }));
  EXPECT_FALSE(is_taken([](LearnedSensor& bad) { bad.rise = test::no_value; }));
  // What is too large is as much as there may be.
  EXPECT_TRUE(is_taken([](LearnedSensor& bad) {
    bad.sample_count = bad.residual_count = bad.roughness_count = bad.step_count =
        bad.wander_count = 4'000'000'000u;
    bad.rise = bad.fall = 1e50;
    bad.disagrees = true;
  }));
  site.run(60);
  EXPECT_FALSE(site.of(row).disagrees) << "it ends as any other";
}

// Of the nodes every third has a sensor: the others are no evidence, whatever is given for them,
// and a sensor that comes or goes leaves those that stay alone.
TEST(Disagreement, IsOfNodesThatHaveASensor) {
  const Snapshot snapshot = test::snapshot_of({"", hundred_nodes(24), {}});
  std::vector<std::uint32_t> rows;
  for (std::uint32_t row = 0; row < 100; row += 3) rows.push_back(row);
  const auto room = static_cast<std::uint32_t>(rows.size());
  NearestNodes nodes(100, room);
  nodes.take(snapshot, rows);
  EXPECT_TRUE(nodes.around(1).empty());
  EXPECT_FALSE(nodes.around(3).empty());
  DisagreementWatch watch(nodes, 100, room);
  watch.take(snapshot, test::sensors_in(rows));
  EXPECT_EQ(watch.sensor_count(), rows.size());
  std::vector<double> values(100, 20.0);
  for (std::uint32_t row = 1; row < 100; row += 3) values[row] = 1000.0 * row;
  for (int sample = 0; sample < learned_after; ++sample) watch.observe(values);
  EXPECT_TRUE(watch.of(30).is_judged);
  EXPECT_NEAR(*watch.of(30).expected, 20.0, 1e-6);
  EXPECT_FALSE(watch.of(31).expected);
  values[30] = 25;
  for (int sample = 0; sample < found_within; ++sample) watch.observe(values);
  EXPECT_TRUE(watch.of(30).disagrees);
  // The first goes, 31 comes in its place.
  rows.front() = 31;
  const std::vector<PlacedSensor> sensors = test::sensors_in(rows);
  const test::AllocationWatch allocations;
  nodes.take(snapshot, rows);
  watch.take(snapshot, sensors);
  EXPECT_EQ(allocations.allocations(), 0u);
  EXPECT_FALSE(watch.has_sensor(0));
  EXPECT_TRUE(watch.has_sensor(31));
  EXPECT_FALSE(watch.of(31).is_judged);
  EXPECT_TRUE(watch.of(30).disagrees);
  EXPECT_TRUE(watch.of(33).is_judged);
  // A row twice, one beyond the site, and one of no node.
  Snapshot other = snapshot;
  other.vertices[60].kind = VertexKind::none;
  const std::vector<std::uint32_t> odd = {30, 30, 60, 100, 4'000'000'000u};
  nodes.take(other, odd);
  watch.take(other, test::sensors_in(odd));
  EXPECT_EQ(watch.sensor_count(), 1u);
  EXPECT_TRUE(watch.of(30).disagrees);
  watch.observe(values);
}

TEST(Disagreement, TakesNoMemoryLater) {
  WatchedSite site(hundred_nodes(23), calm, 23);
  const std::vector<PlacedSensor> sensors = test::sensors_in(test::rows_of(site.snapshot()));
  std::vector<double> values(100, 1.0);
  values[3] = test::no_value;
  const test::AllocationWatch watch;
  for (int sample = 0; sample < learned_after; ++sample) {
    values[static_cast<std::size_t>(sample) % 100] += 1;
    site.watch().observe(values);
  }
  site.watch().take(site.snapshot(), sensors);
  EXPECT_EQ(watch.allocations(), 0u);
}

}  // namespace
}  // namespace etcm::firmware
