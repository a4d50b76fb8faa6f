// Schedules of faults by theme. More of them, or others:
//   ETCM_FLEET_SCHEDULES=10000 ETCM_FLEET_FIRST=1 build/release/tests/bin/fleet_simulation_test
// ETCM_FLEET_VERBOSE=1 tells what happens in them.
#include "simulation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include "support/emulated.h"

namespace etcm::test {
namespace {

std::uint64_t from_environment(const char* name, std::uint64_t otherwise) {
  const char* const text = std::getenv(name);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

void run(const Theme& theme, std::uint64_t usual) {
  const std::uint64_t count =
      from_environment("ETCM_FLEET_SCHEDULES", 1 + usual / thinning_if_slow);
  const std::uint64_t first = from_environment("ETCM_FLEET_FIRST", 1);
  std::vector<double> agreed;
  std::uint64_t messages = 0, wrong = 0;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    const Outcome outcome = simulate(theme, seed);
    if (!outcome.wrong.empty()) {
      ADD_FAILURE() << theme.name << ", seed " << seed << ": " << outcome.wrong;
      if (++wrong == 5) break;
    }
    agreed.push_back(outcome.agreed_after_s);
    messages += outcome.messages;
  }
  std::sort(agreed.begin(), agreed.end());
  std::printf(
      "%s: %zu schedules, %llu wrong; agreed after %.1f s (median), %.1f s (all); "
      "%.0f messages a schedule\n",
      theme.name, agreed.size(), static_cast<unsigned long long>(wrong), agreed[agreed.size() / 2],
      agreed.back(), static_cast<double>(messages) / static_cast<double>(agreed.size()));
}

TEST(FleetSimulation, NothingFails) { run({.name = "nothing"}, 30); }
TEST(FleetSimulation, GatewaysDie) { run({.name = "deaths", .deaths = true}, 60); }
TEST(FleetSimulation, ConnectionsAreCut) { run({.name = "cuts", .cuts = true}, 40); }
TEST(FleetSimulation, TheSiteIsSplit) { run({.name = "splits", .splits = true}, 50); }
TEST(FleetSimulation, BrokersForget) {
  run({.name = "forgets", .cuts = true, .forgets = true}, 50);
}
TEST(FleetSimulation, MessagesComeAgain) { run({.name = "doubles", .doubles = true}, 30); }
TEST(FleetSimulation, TwoHaveOneName) { run({.name = "twins", .twins = true}, 40); }
TEST(FleetSimulation, SomebodyTalksRubbish) { run({.name = "rubbish", .rubbish = true}, 40); }
TEST(FleetSimulation, ClocksDiffer) {
  run({.name = "clocks", .deaths = true, .cuts = true, .clocks = true}, 50);
}
TEST(FleetSimulation, AllOfItHappens) {
  run({.name = "all",
       .deaths = true,
       .cuts = true,
       .splits = true,
       .forgets = true,
       .doubles = true,
       .twins = true,
       .rubbish = true,
       .clocks = true},
      60);
}

}  // namespace
}  // namespace etcm::test
