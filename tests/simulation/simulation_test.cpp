// Lives of a site and its gateway. More of them, or others, or one again:
//   ETCM_SIMULATION_DAYS=100 ETCM_SIMULATION_FIRST=1 build/release/tests/bin/simulation_test
// ETCM_SIMULATION_VERBOSE=1 tells what happens in them.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>

#include "life.h"
#include "support/emulated.h"

namespace etcm::simulation {
namespace {

using namespace std::chrono_literals;

std::uint64_t from_environment(const char* name, std::uint64_t otherwise) {
  const char* const text = std::getenv(name);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

// Each of these lives has shown a fault once.
TEST(Simulation, AGatewayLivesThroughWhatItFailedAtBefore) {
  constexpr std::array<std::uint64_t, 7> seeds{
      20261126015,  // a late answer, where two at one address had answered in time
      20261127077,  // one that is always as late spoils the same one's answers
      7083,         // a converter had given up a dead unit, and that was taken for no queue
      20261128554,  // units that others held up had the time of dead ones
      25112026346,  // one slow answer had each question in vain wait five seconds ever after
      // A late answer, where two at one address had answered in pieces.
      26112600400564,
      26112600500693,  // the second of two at one address talked over another unit each time
  };
  for (const std::uint64_t seed : seeds) {
    const Outcome life = live(seed, 6h, Company::nobody);
    EXPECT_EQ(life.wrong, "") << "seed " << seed;
  }
  // A number of Modbus TCP came again, and what had it before was never answered.
  EXPECT_EQ(live(238, 6h, Company::others).wrong, "");
  // A lost unit that cost much was never asked again beside others that cost less.
  EXPECT_EQ(live(7700035, 6h, Company::others_and_newcomers).wrong, "");
  // A unit was given that was looked at twice in vain, while a poll was answered there.
  EXPECT_EQ(live(8110015, 6h, Company::others_and_newcomers).wrong, "");
  // And one that was looked at twice while a dead unit held the converter up.
  EXPECT_EQ(live(50009075, 6h, Company::others_and_newcomers).wrong, "");
  // What a unit told looked like a frame in the middle of its answer, and spoilt that each time.
  EXPECT_EQ(live(190045063, 6h, Company::others_and_newcomers).wrong, "");
  // One whose place the broker had told was left there when the plane changed.
  EXPECT_EQ(live(200067065, 6h, Company::others_and_makes).wrong, "");
  // A site file that was taken out and put in again was less than itself of before.
  EXPECT_EQ(live(200040058, 6h, Company::others).wrong, "");
  // A site file had the number that one of an earlier run had, which was told and not saved.
  EXPECT_EQ(live(310002037, 6h, Company::others_and_makes).wrong, "");
  // The second block of a device waited for a share that the first one had used up, for ever.
  EXPECT_EQ(live(80045069, 6h, Company::others_and_makes).wrong, "");
  // A reload took features out that somebody was reading about.
  EXPECT_EQ(live(26122700000378, 6h, Company::others).wrong, "");
}

TEST(Simulation, AGatewayLivesThroughAllOfIt) {
  const std::uint64_t hours_each = from_environment("ETCM_SIMULATION_HOURS", 6);
  const std::uint64_t days = from_environment("ETCM_SIMULATION_DAYS", 20 / test::thinning_if_slow);
  const std::uint64_t first = from_environment("ETCM_SIMULATION_FIRST", 1);
  const std::uint64_t count =
      from_environment("ETCM_SIMULATION_LIVES", std::max<std::uint64_t>(days * 24 / hours_each, 1));
  const std::uint64_t wrong_max = from_environment("ETCM_SIMULATION_WRONG", 5);
  Outcome all;
  std::uint64_t wrong = 0;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    // Of three one with nobody else.
    const Company company = seed % 3 == 0   ? Company::nobody
                            : seed % 4 == 1 ? Company::others_and_makes
                            : seed % 4 == 3 ? Company::others_and_newcomers
                                            : Company::others;
    const Outcome life = live(seed, hours_each * 1h, company);
    if (!life.wrong.empty()) {
      ADD_FAILURE() << "seed " << seed << ", " << life.wrong
                    << "\nagain: ETCM_SIMULATION_LIVES=1 ETCM_SIMULATION_FIRST=" << seed
                    << " ETCM_SIMULATION_HOURS=" << hours_each
                    << " ETCM_SIMULATION_VERBOSE=1 build/release/tests/bin/simulation_test";
      if (++wrong == wrong_max) break;
    }
    all.lived += life.lived;
    all.steps += life.steps;
    all.positions += life.positions;
    all.positions_of_others += life.positions_of_others;
    all.generations += life.generations;
    all.rebuilt += life.rebuilt;
    all.given += life.given;
    all.births += life.births;
    all.lists += life.lists;
    all.requests += life.requests;
    for (std::size_t i = 0; i < event_count; ++i) all.events[i] += life.events[i];
  }
  std::printf(
      "%.1f days, %llu steps, %llu positions, %llu of others, %llu generations, "
      "%llu compared with build(), "
      "%llu units given, %llu births, %llu lists of neighbours, "
      "%llu answers to others\n",
      std::chrono::duration<double>(all.lived).count() / 86400,
      static_cast<unsigned long long>(all.steps), static_cast<unsigned long long>(all.positions),
      static_cast<unsigned long long>(all.positions_of_others),
      static_cast<unsigned long long>(all.generations),
      static_cast<unsigned long long>(all.rebuilt), static_cast<unsigned long long>(all.given),
      static_cast<unsigned long long>(all.births), static_cast<unsigned long long>(all.lists),
      static_cast<unsigned long long>(all.requests));
  // Else it would have shown nothing.
  EXPECT_GT(all.positions, 0u);
  EXPECT_GT(all.rebuilt, 0u);
  // One life that is lived again may have no others.
  if (count > 1) {
    EXPECT_GT(all.requests, 0u);
    EXPECT_GT(all.positions_of_others, 0u);
    EXPECT_GT(all.births, 0u);
    EXPECT_GT(all.lists, 0u);
  }
  // One life of six has nodes without a unit, and not each of these has room for them.
  if (count >= 20) {
    EXPECT_GT(all.given, 0u);
  }
}

}  // namespace
}  // namespace etcm::simulation
