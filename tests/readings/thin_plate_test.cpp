// What the nodes around a node say of its reading.
#include "firmware/readings/thin_plate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "expected.h"
#include "simulated_site.h"
#include "support/allocation_watch.h"
#include "support/emulated.h"
#include "support/meshes.h"

namespace etcm::firmware {
namespace {

struct ExpectedSite {
  explicit ExpectedSite(const inputs::Graph& graph)
      : snapshot(test::snapshot_of(graph)),
        nodes(static_cast<std::uint32_t>(snapshot.vertices.size()),
              static_cast<std::uint32_t>(snapshot.vertices.size())) {
    nodes.take(snapshot, test::rows_of(snapshot));
  }
  std::uint32_t row_count() const { return static_cast<std::uint32_t>(snapshot.vertices.size()); }
  std::vector<double> linear(double a, double b, double c) const {
    std::vector<double> values(row_count());
    for (std::uint32_t row = 0; row < row_count(); ++row) {
      values[row] = a + b * test::x_of(snapshot, row) + c * test::y_of(snapshot, row);
    }
    return values;
  }

  Snapshot snapshot;
  NearestNodes nodes;
};

struct Misses {
  double mean_square = 0;
  int count = 0;
  int within_two_deviations = 0;
  int unexpected = 0;
};

Misses misses_of(const ExpectedSite& site, const std::vector<double>& values) {
  Misses misses;
  for (std::uint32_t row = 0; row < site.row_count(); ++row) {
    const auto expected = expected_value(site.nodes, values, row);
    if (!expected || !expected->uncertainty) {
      ++misses.unexpected;
      continue;
    }
    const double miss = expected->value - values[row];
    misses.mean_square += miss * miss;
    ++misses.count;
    if (std::abs(miss) <= 2 * *expected->uncertainty) ++misses.within_two_deviations;
  }
  misses.mean_square /= misses.count;
  return misses;
}

TEST(ExpectedValue, OfALinearFieldIsExactInsideAndAtTheHull) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const ExpectedSite site(
        {"", test::scattered(4 + 5 * static_cast<std::size_t>(seed), 1'000'000, seed), {}});
    const auto values = site.linear(20, 3e-5, -7e-5);
    int predicted = 0;
    for (std::uint32_t row = 0; row < site.row_count(); ++row) {
      const auto expected = expected_value(site.nodes, values, row);
      if (!expected) continue;
      ++predicted;
      EXPECT_NEAR(expected->value, values[row], 1e-9) << "row " << row << ", seed " << seed;
      if (expected->uncertainty) {
        EXPECT_LT(*expected->uncertainty, 1e-5);
      }
    }
    EXPECT_GE(predicted, static_cast<int>(site.row_count()) - 2) << "seed " << seed;
  }
}

TEST(ExpectedValue, OfALinearFieldIsExactAlongAFeatureWithSteinerVertices) {
  std::vector<Position> positions{{0, 0}, {10'000, 0}};
  for (int i = 1; i < 10; ++i) {
    positions.push_back({1000 * i + 130, 90 - i});
    positions.push_back({1000 * i - 70, -60});
  }
  const ExpectedSite site({"", positions, {test::between_nodes(0, 1)}});
  const auto values = site.linear(-4, 1e-3, 2e-2);
  for (std::uint32_t row = 0; row < positions.size(); ++row) {
    const auto expected = expected_value(site.nodes, values, row);
    ASSERT_TRUE(expected) << row;
    EXPECT_NEAR(expected->value, values[row], 1e-9) << row;
  }
  EXPECT_FALSE(expected_value(site.nodes, values, static_cast<std::uint32_t>(positions.size())));
}

// The figures of firmware/readings/README.md, with room for another library's logarithm.
TEST(ExpectedValue, OfSmoothFieldsMissesByLittle) {
  const struct {
    double length;
    double miss_max;
  } cases[] = {{600'000, 0.0045}, {300'000, 0.010}, {150'000, 0.027}};
  for (const auto& [length, miss_max] : cases) {
    Misses all;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const ExpectedSite site({"", test::scattered(200, 1'000'000, seed), {}});
      const Misses misses = misses_of(site, test::smooth_field(site.snapshot, length, seed));
      all.mean_square += misses.mean_square / 10;
      all.count += misses.count;
      all.within_two_deviations += misses.within_two_deviations;
      all.unexpected += misses.unexpected;
    }
    EXPECT_LT(std::sqrt(all.mean_square), miss_max) << length;
    EXPECT_GT(all.within_two_deviations, all.count * 9 / 10) << length;
    EXPECT_LE(all.unexpected, 4) << length;
  }
}

TEST(ExpectedValue, GainIsThatOfTheNoiseAround) {
  const ExpectedSite site({"", test::scattered(60, 1'000'000, 7), {}});
  const std::uint32_t row = 30;
  std::vector<double> values(site.row_count(), 0.0);
  const auto expected = expected_value(site.nodes, values, row);
  ASSERT_TRUE(expected);
  double squares = 0;
  for (std::uint32_t other = 0; other < site.row_count(); ++other) {
    if (other == row) continue;
    values[other] = 1;
    const double weight = expected_value(site.nodes, values, row)->value;
    squares += weight * weight;
    values[other] = 0;
  }
  EXPECT_NEAR(std::sqrt(squares), expected->noise_gain, 1e-9);
}

TEST(ExpectedValue, LeavesTheSensorItselfOut) {
  const ExpectedSite site({"", test::scattered(60, 1'000'000, 8), {}});
  auto values = test::smooth_field(site.snapshot, 300'000, 8);
  for (std::uint32_t row = 0; row < site.row_count(); ++row) {
    const double own = values[row];
    const auto before = expected_value(site.nodes, values, row);
    for (const double reading : {1e9, -1e300, test::no_value}) {
      values[row] = reading;
      const auto after = expected_value(site.nodes, values, row);
      ASSERT_TRUE(before && after);
      EXPECT_EQ(after->value, before->value);
      EXPECT_EQ(after->uncertainty, before->uncertainty);
    }
    values[row] = own;
  }
}

TEST(ExpectedValue, MissingReadingsAreLeftOut) {
  const ExpectedSite site({"", test::scattered(120, 1'000'000, 9), {}});
  const auto linear = site.linear(5, 1e-5, 1e-5);
  std::mt19937_64 random(9);
  for (int percent = 0; percent <= 100; percent += 10) {
    auto values = linear;
    for (double& value : values) {
      if (random() % 100 >= static_cast<unsigned>(percent)) continue;
      const double missing[] = {test::no_value, std::numeric_limits<double>::infinity(),
                                -std::numeric_limits<double>::infinity()};
      value = missing[random() % 3];
    }
    int predicted = 0;
    for (std::uint32_t row = 0; row < site.row_count(); ++row) {
      const auto expected = expected_value(site.nodes, values, row);
      if (!expected) continue;
      ++predicted;
      EXPECT_NEAR(expected->value, linear[row], 1e-8);
      if (expected->uncertainty) {
        EXPECT_TRUE(std::isfinite(*expected->uncertainty));
      }
    }
    if (percent <= 50) {
      EXPECT_GE(predicted, 115) << percent;
    }
    if (percent == 100) {
      EXPECT_EQ(predicted, 0);
    }
  }
  // A list that is too short has no values at its end.
  EXPECT_FALSE(expected_value(site.nodes, {}, 0));
  EXPECT_FALSE(expected_value(site.nodes, linear, 120));
  EXPECT_FALSE(expected_value(site.nodes, linear, no_row));
}

TEST(ExpectedValue, OfEqualReadingsIsThatReading) {
  const ExpectedSite site({"", test::scattered(60, 1'000'000, 10), {}});
  for (const double reading : {0.0, 21.7, -1e-300, 1e300}) {
    const std::vector<double> values(site.row_count(), reading);
    for (std::uint32_t row = 0; row < site.row_count(); ++row) {
      const auto expected = expected_value(site.nodes, values, row);
      ASSERT_TRUE(expected);
      EXPECT_EQ(expected->value, reading);
      EXPECT_EQ(expected->uncertainty, 0.0);
    }
  }
}

TEST(ExpectedValue, IsNeverInfinite) {
  const ExpectedSite site({"", test::scattered(60, 1'000'000, 11), {}});
  std::mt19937_64 random(11);
  std::vector<double> values(site.row_count());
  for (double& value : values) value = random() % 2 == 0 ? 1.7e308 : -1.7e308;
  for (std::uint32_t row = 0; row < site.row_count(); ++row) {
    const auto expected = expected_value(site.nodes, values, row);
    if (!expected) continue;
    EXPECT_TRUE(std::isfinite(expected->value));
    EXPECT_TRUE(std::isfinite(expected->uncertainty.value_or(0)));
  }
}

// Too few nodes, nodes on one line, nodes far outside: an answer where there is one, else none.
TEST(ExpectedValue, IsNoneWhereItCannotBeTold) {
  const struct {
    const char* name;
    std::vector<Position> positions;
    bool answers;  // of the first node
    bool is_uncertain;
  } cases[] = {
      {"alone", {{0, 0}}, false, false},
      {"two", {{0, 0}, {10, 0}}, false, false},
      {"a triangle", {{0, 0}, {10, 0}, {0, 10}}, false, false},
      {"between two on a line", {{5, 5}, {0, 0}, {10, 10}}, true, false},
      {"between four on a line", {{5, 5}, {0, 0}, {10, 10}, {20, 20}, {-3, -3}}, true, true},
      {"beside a line", {{5, 6}, {0, 0}, {10, 10}, {20, 20}}, false, false},
      {"at the end of a line", {{0, 0}, {10, 10}, {20, 20}}, true, false},
      {"far beyond the end of a line", {{-90, -90}, {10, 10}, {20, 20}}, false, false},
      {"a square", {{0, 0}, {10, 0}, {0, 10}, {10, 10}}, true, false},
      {"the middle of a square", {{5, 5}, {0, 0}, {10, 0}, {0, 10}, {10, 10}}, true, true},
      {"far outside", {{90'000, 3}, {0, 0}, {10, 0}, {0, 10}, {10, 10}}, false, false},
      {"a line that is hardly one",
       {{500'000, 0}, {0, 0}, {1'000'000, 1}, {2'000'000, 0}, {3'000'000, 1}},
       true,
       true},
  };
  for (const auto& [name, positions, answers, is_uncertain] : cases) {
    const ExpectedSite site({"", positions, {}});
    const auto values = site.linear(1, 0.5, -0.25);
    const auto expected = expected_value(site.nodes, values, 0);
    EXPECT_EQ(expected.has_value(), answers) << name;
    if (!expected) continue;
    EXPECT_NEAR(expected->value, values[0], 1e-9 * (1 + std::abs(values[0]))) << name;
    EXPECT_EQ(expected->uncertainty.has_value(), is_uncertain) << name;
    EXPECT_LE(expected->noise_gain, noise_gain_max) << name;
  }
}

// Nothing of it depends on where the site is, how it is turned, or in which unit.
TEST(ThinPlate, IsTheSameInAnyUnitAndTurn) {
  const std::vector<Offset> places{{3, 1}, {-2, 2}, {-1, -3}, {4, -2}, {0.5, 5}};
  const std::vector<double> values{1, 4, 2, 8, 5};
  ThinPlate plain;
  ASSERT_TRUE(plain.fit(places));
  for (const double scale : {1e-9, 1.0, 1e9}) {
    std::vector<Offset> turned;
    for (const Offset& place : places) {
      turned.push_back(
          {scale * (0.6 * place.x - 0.8 * place.y), scale * (0.8 * place.x + 0.6 * place.y)});
    }
    ThinPlate other;
    ASSERT_TRUE(other.fit(turned));
    EXPECT_NEAR(other.value(values), plain.value(values), 1e-9);
    EXPECT_NEAR(other.noise_gain(), plain.noise_gain(), 1e-9);
    EXPECT_NEAR(other.deviation(values), plain.deviation(values), 1e-9);
  }
}

TEST(ExpectedValue, TakesNoMemory) {
  const ExpectedSite site({"", test::scattered(60, 1'000'000, 12), {}});
  const auto values = test::smooth_field(site.snapshot, 300'000, 12);
  const test::AllocationWatch watch;
  for (std::uint32_t row = 0; row < site.row_count(); ++row) {
    EXPECT_TRUE(expected_value(site.nodes, values, row));
  }
  EXPECT_EQ(watch.allocations(), 0u);
}

}  // namespace
}  // namespace etcm::firmware
