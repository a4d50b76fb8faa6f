// etcm-tiles: a site that is too large for one machine, cut into tiles, beside the one mesh.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "bench/tiles/feature_table.h"
#include "bench/tiles/quad_tree.h"
#include "bench/tiles/sites.h"
#include "bench/tiles/survey.h"
#include "command_line/command_line.h"

namespace {

using namespace etcm;
using namespace etcm::bench;

struct Options {
  std::size_t nodes = 100'000;
  std::uint32_t tiles = 64;
  std::uint32_t cell = 32;
  std::vector<std::string> sites;
  std::size_t moves = 10'000;
  std::size_t features = 0;
  std::uint64_t seed = 1;
};

void print_head() {
  std::puts(
      "Of three figures the first is the mean, the second what 99 % do not exceed, the third the"
      " worst.\n\n"
      "| site | nodes | tiles | triangles | halo, % of own nodes | subscriptions | tiles heard "
      "from |"
      " meshes made | told of a step | told of a jump | cells asked for a move |"
      " us a node in tiles | in one mesh |\n"
      "|---|---:|---:|---|---|---|---|---|---|---|---:|---:|---:|");
}

// Whether the tiles' triangles are those of the one mesh.
bool print_site(const NamedSpread& site, const Options& options) {
  const std::vector<std::uint64_t> codes = spread_nodes(site.spread, options.nodes, options.seed);
  const QuadTree tree(codes, site_bits, options.cell);
  const double nodes = static_cast<double>(codes.size());
  // Squares are cut in four, so a tile has between a quarter of the most and the most.
  const auto nodes_max = static_cast<std::uint32_t>(std::max(1.0, 1.75 * nodes / options.tiles));
  Survey survey = survey_tiles(tree, nodes_max);
  const double start = processor_seconds();
  const TriangleSum whole = one_mesh(tree);
  const double whole_s = processor_seconds() - start;
  const bool is_same = survey.sum == whole;
  Hearing hearing = hear_moves(tree, survey, options.moves, options.seed);
  std::printf("| %s | %zu | %zu | %llu, %s | %s | %s | %s | %s | %s | %s | %.4f | %.2f | %.2f |\n",
              std::string(site.name).c_str(), codes.size(), survey.tiles.size(),
              static_cast<unsigned long long>(survey.sum.count),
              is_same ? "the same" : "NOT THE SAME", survey.halo_percent.text(1).c_str(),
              survey.filters.text(0).c_str(), survey.sources.text(0).c_str(),
              survey.meshes.text(0).c_str(), hearing.of_step.text(0).c_str(),
              hearing.of_jump.text(0).c_str(), hearing.asked.mean(), 1e6 * survey.seconds / nodes,
              1e6 * whole_s / nodes);
  std::fflush(stdout);
  return is_same;
}

bool is_asked_for(const Options& options, const NamedSpread& site) {
  return options.sites.empty() ||
         std::find(options.sites.begin(), options.sites.end(), site.name) != options.sites.end();
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app(
      "Cuts a site into tiles whose members know little more than their own, and compares\n"
      "what they come to with the one mesh. Prints Markdown; ends with 0 if all is the same.",
      "etcm-tiles");
  std::vector<std::string> names;
  for (const NamedSpread& site : spreads) names.emplace_back(site.name);
  app.add_option("--nodes", options.nodes, "of a site")
      ->capture_default_str()
      ->check(CLI::Range(1, 50'000'000));
  app.add_option("--tiles", options.tiles, "about so many")
      ->capture_default_str()
      ->check(CLI::Range(1, 1'000'000));
  app.add_option("--cell", options.cell, "nodes of a cell, at most")
      ->capture_default_str()
      ->check(CLI::Range(1, 1'000'000));
  app.add_option("--site", options.sites, "only sites with this name")->check(CLI::IsMember(names));
  app.add_option("--moves", options.moves, "to count messages of")->capture_default_str();
  app.add_option("--features", options.features,
                 "instead: which tiles the laying of a feature depends on; so many are tried");
  app.add_option("--seed", options.seed, "of the sites")->capture_default_str();
  if (const auto end = command_line::parse(app, argc, argv)) return *end;
  try {
    if (options.features > 0) {
      const bool is_alike = print_feature_table({.nodes = options.nodes,
                                                 .tiles = options.tiles,
                                                 .samples = options.features,
                                                 .seed = options.seed});
      return is_alike ? 0 : 1;
    }
    print_head();
    bool is_all_the_same = true;
    for (const NamedSpread& site : spreads) {
      if (is_asked_for(options, site)) is_all_the_same &= print_site(site, options);
    }
    return is_all_the_same ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "etcm-tiles: %s\n", error.what());
    return 1;
  }
}
