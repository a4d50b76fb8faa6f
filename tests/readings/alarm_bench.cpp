// How often sound sensors are said to disagree, and how soon one that is off is found: the table of
// firmware/readings/README.md, on simulated sites. One sample is one minute. Reports, and judges
// nothing.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <optional>
#include <vector>

#include "firmware/readings/disagreement.h"
#include "moving_field.h"
#include "simulated_site.h"

namespace {

using namespace etcm;

constexpr double minutes_of_a_year = 365 * 24 * 60;
constexpr int learned_after = 400;
constexpr int searched_for = 200;
constexpr int found_within = 10;
constexpr double offset = 0.05;

struct Family {
  std::uint32_t nodes;
  double length, swing, noise;
};
constexpr Family families[] = {
    {100, 0.4, 0.05, 0.001}, {100, 0.4, 0.05, 0.01}, {100, 0.4, 0.05, 0.02}, {100, 0.4, 0.1, 0.001},
    {100, 0.4, 0.1, 0.01},   {100, 0.4, 0.1, 0.02},  {50, 0.4, 0.1, 0.001},  {50, 0.4, 0.1, 0.01},
    {50, 0.4, 0.1, 0.02},    {30, 0.4, 0.1, 0.01},   {50, 0.6, 0.2, 0.01},   {100, 0.25, 0.1, 0.01},
    {200, 0.25, 0.1, 0.02},
};

struct Figures {
  double node_years = 0;
  int false_alarms = 0;
  std::vector<int> samples_until_found;  // searched_for: not found
};

class SimulatedSite {
 public:
  SimulatedSite(const Family& family, std::uint64_t seed, std::uint64_t noise_seed)
      : snapshot_(test::snapshot_of({"", test::scattered(family.nodes, 1'000'000, seed), {}})),
        rows_(test::rows_of(snapshot_)),
        nodes_(family.nodes, family.nodes),
        field_(snapshot_,
               {.noise = family.noise, .length = family.length, .shape_swing = family.swing},
               noise_seed),
        watch_(nodes_, family.nodes, family.nodes),
        disagreed_(family.nodes) {
    nodes_.take(snapshot_, rows_);
    watch_.take(snapshot_, test::sensors_in(rows_));
  }

  void sample(std::optional<std::uint32_t> spoiled = {}) {
    auto& values = field_.next();
    if (spoiled) values[*spoiled] += offset;
    watch_.observe(values);
    for (const std::uint32_t row : rows_) {
      const bool disagrees = watch_.of(row).disagrees;
      if (disagrees && !disagreed_[row]) ++alarms_;
      disagreed_[row] = disagrees;
    }
  }
  bool disagrees(std::uint32_t row) const { return disagreed_[row]; }
  int alarms() const { return alarms_; }

 private:
  firmware::Snapshot snapshot_;
  std::vector<std::uint32_t> rows_;
  firmware::NearestNodes nodes_;
  test::MovingField field_;
  firmware::DisagreementWatch watch_;
  std::vector<bool> disagreed_;
  int alarms_ = 0;
};

void count_false_alarms(const Family& family, std::uint64_t seed, int samples, Figures& figures) {
  SimulatedSite site(family, seed, seed);
  for (int i = 0; i < samples; ++i) site.sample();
  figures.node_years += static_cast<double>(family.nodes) * samples / minutes_of_a_year;
  figures.false_alarms += site.alarms();
}

int samples_until_found(const Family& family, std::uint64_t seed, std::uint32_t row) {
  SimulatedSite site(family, seed, 1000 * seed + row);
  for (int i = 0; i < learned_after; ++i) site.sample();
  for (int i = 1; i < searched_for; ++i) {
    site.sample(row);
    if (site.disagrees(row)) return i;
  }
  return searched_for;
}

void print(const Family& family, Figures& figures) {
  auto& found = figures.samples_until_found;
  std::sort(found.begin(), found.end());
  const auto in_time = std::upper_bound(found.begin(), found.end(), found_within) - found.begin();
  const auto at = [&](double share) {
    return found[static_cast<std::size_t>(share * static_cast<double>(found.size() - 1))];
  };
  std::printf("| %u, %g, %g %% | %g | %.1f (%.0f) | %.0f %% of %zu | %d, %d |\n", family.nodes,
              family.length, 100 * family.swing, 100 * family.noise,
              figures.false_alarms / figures.node_years, figures.node_years,
              100.0 * static_cast<double>(in_time) / static_cast<double>(found.size()),
              found.size(), at(0.5), at(0.9));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("False alarms and offsets found, family by family of simulated sites.");
  int sites = 10, days = 4, first = 0, last = static_cast<int>(std::size(families)) - 1;
  std::uint32_t offsets = 50;
  std::uint64_t seed = 1001;
  app.add_option("--sites", sites, "of each family");
  app.add_option("--days", days, "that each is watched");
  app.add_option("--offsets", offsets, "sensors of each that are spoiled, one at a time");
  app.add_option("--seed", seed, "of the first site");
  app.add_option("--first", first, "family");
  app.add_option("--last", last, "family");
  CLI11_PARSE(app, argc, argv);
  std::printf(
      "| nodes, correlation length, swing | noise, %% of range | false alarms a node-year (in "
      "years) "
      "| found within 10 samples | samples until found: median, 90 %% |\n|---|---|---|---|---|\n");
  for (int number = first; number <= last; ++number) {
    const Family& family = families[number];
    Figures figures;
    for (int i = 0; i < sites; ++i) {
      const std::uint64_t site_seed = seed + static_cast<std::uint64_t>(i);
      count_false_alarms(family, site_seed, days * 1440, figures);
      const std::uint32_t tried = std::min(offsets, family.nodes);
      for (std::uint32_t k = 0; k < tried; ++k) {
        figures.samples_until_found.push_back(
            samples_until_found(family, site_seed, k * family.nodes / tried));
      }
    }
    print(family, figures);
  }
}
