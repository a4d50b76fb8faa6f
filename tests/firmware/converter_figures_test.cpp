// What dead units behind a converter cost the others with the default settings: in polls, against
// the same line without them, and in the age of positions, against the best order there is.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "converter_site.h"
#include "support/emulated.h"

namespace etcm::firmware {
namespace {

using Times = std::array<std::vector<port::Instant>, 256>;  // of readings, by unit
using Holds = std::vector<std::pair<port::Instant, port::Instant>>;

std::vector<std::uint8_t> healthy_of(const Behind& behind) {
  std::vector<std::uint8_t> healthy;
  for (std::uint8_t unit = 1; unit <= behind.units; ++unit) {
    if (std::find(behind.dead.begin(), behind.dead.end(), unit) == behind.dead.end()) {
      healthy.push_back(unit);
    }
  }
  return healthy;
}

struct Figures {
  std::size_t readings = 0;
  port::Duration age_p99{};
};

Figures figures_of(const Behind& behind, const Times& times, port::Instant from, port::Instant to) {
  Figures figures;
  std::vector<port::Duration> ages;
  for (const std::uint8_t unit : healthy_of(behind)) {
    auto next = times[unit].begin();
    const auto end = times[unit].end();
    port::Instant last = from;
    for (port::Instant now = from; now < to; now += 5ms) {
      for (; next != end && *next <= now; ++next) {
        last = *next;
        figures.readings += from <= *next ? 1 : 0;
      }
      ages.push_back(now - std::max(last, from));
    }
  }
  const auto p99 = ages.begin() + static_cast<std::ptrdiff_t>(ages.size() / 100 * 99);
  std::nth_element(ages.begin(), p99, ages.end());
  figures.age_p99 = *p99;
  return figures;
}

// Whoever has waited longest, on a line of which all is known beforehand but for the times when
// dead units hold it.
Times best_times(const Behind& behind, const Holds& holds, port::Instant from, port::Instant to) {
  std::vector<std::pair<port::Instant, std::uint8_t>> due;
  for (const std::uint8_t unit : healthy_of(behind)) due.emplace_back(from, unit);
  Times times;
  auto hold = holds.begin();
  for (port::Instant now = from; now < to;) {
    for (; hold != holds.end() && hold->first <= now; ++hold) now = std::max(now, hold->second);
    auto& first = *std::min_element(due.begin(), due.end());
    if (first.first > now) {
      now = hold == holds.end() ? first.first : std::min(first.first, hold->first);
      continue;
    }
    const bool is_on_time = now - first.first < 1s;
    first.first = (is_on_time ? first.first : now) + 1s;
    now += behind.exchange;
    times[first.second].push_back(now);
  }
  return times;
}

struct DeadUnits {
  const char* name;
  Behind behind;
  port::Duration warm_up;
  port::Duration time;
};

constexpr port::Duration four_minutes = 4min;

class CostOfDeadUnits : public testing::TestWithParam<DeadUnits> {};

TEST_P(CostOfDeadUnits, IsOnePollInAHundredAndATenthOfTheAge) {
  const auto& [name, behind, warm_up, longest] = GetParam();
  // Four minutes have each kind of question in vain in them; ten show how seldom it is.
  const port::Duration time =
      test::thinning_if_emulated > 1 ? std::min(longest, four_minutes) : longest;
  const port::Instant from = port::Instant{1h} + warm_up;
  const port::Instant to = from + time;
  ConverterSite site(behind);
  std::vector<UnitRange> healthy;
  for (const std::uint8_t unit : healthy_of(behind)) healthy.push_back({unit, unit});
  ConverterSite without(behind, healthy);
  for (ConverterSite* const each : {&site, &without}) each->run_for(warm_up + time);
  Holds holds;
  for (const auto& hold : site.device.holds) {
    if (hold.second > from) holds.push_back(hold);
  }
  EXPECT_FALSE(holds.empty()) << "they may come back";
  const Figures found = figures_of(behind, site.read_at, from, to);
  const Figures alone = figures_of(behind, without.read_at, from, to);
  const Figures best = figures_of(behind, best_times(behind, holds, from, to), from, to);
  EXPECT_GE(found.readings * 100, alone.readings * 99)
      << found.readings << " of " << alone.readings;
  EXPECT_LE(found.age_p99 * 10, best.age_p99 * 11)
      << found.age_p99 / 1ms << " ms, and at best " << best.age_p99 / 1ms;
  if (warm_up > 0s) {
    EXPECT_LE(found.age_p99 * 10, alone.age_p99 * 11)
        << found.age_p99 / 1ms << " ms, and without " << alone.age_p99 / 1ms;
  }
}

std::vector<std::uint8_t> some_of(std::uint8_t units, std::size_t count, std::uint32_t seed) {
  std::vector<std::uint8_t> all(units);
  for (std::uint8_t i = 0; i < units; ++i) all[i] = static_cast<std::uint8_t>(i + 1);
  std::mt19937 random(seed);
  // Not std::shuffle: that draws otherwise in each library.
  for (std::size_t i = 0; i < count; ++i) std::swap(all[i], all[i + random() % (units - i)]);
  all.resize(count);
  std::sort(all.begin(), all.end());
  return all;
}

INSTANTIATE_TEST_SUITE_P(
    Rows, CostOfDeadUnits,
    testing::Values(
        DeadUnits{"first_at_a_cold_start", {.units = 21, .dead = {1}}, 0s, 45s},
        DeadUnits{"last_at_a_cold_start", {.units = 21, .dead = {21}}, 0s, 45s},
        DeadUnits{"two_of_22", {.units = 22, .dead = some_of(22, 2, 1)}, 60s, 600s},
        DeadUnits{"others_of_22", {.units = 22, .dead = some_of(22, 2, 2)}, 60s, 600s},
        DeadUnits{"that_say_nothing",
                  {.units = 22, .dead = some_of(22, 2, 3), .exception = 0},
                  60s,
                  600s},
        DeadUnits{"six_at_9600_baud",
                  {.units = 60, .dead = some_of(60, 6, 4), .exchange = 50400us},
                  60s,
                  600s},
        DeadUnits{"the_first_six_at_9600_baud",
                  {.units = 60, .dead = {1, 2, 3, 4, 5, 6}, .exchange = 50400us},
                  60s,
                  600s},
        DeadUnits{"six_at_9600_baud_that_say_nothing",
                  {.units = 60, .dead = some_of(60, 6, 5), .exchange = 50400us, .exception = 0},
                  60s,
                  600s}),
    [](const auto& row) { return std::string(row.param.name); });

}  // namespace
}  // namespace etcm::firmware
