#include "compare/measurement.h"

#include <vector>

#include "bench/limited.h"
#include "compare/statistics.h"
#include "compare/variants.h"
#include "inputs/owned_mesh.h"

namespace etcm::compare {
namespace {

constexpr std::uint64_t shuffle_seed = 2015;

// Small graphs take microseconds, so they are repeated until the median means something.
constexpr std::size_t repeats_min = 3;
constexpr std::size_t repeats_max = 15;
constexpr double enough_us = 30'000;

void time_repeatedly(const System& system, const inputs::Graph& graph, Measurement& result) {
  std::vector<double> delaunay, features;
  double total = 0;
  while (delaunay.size() < repeats_min || (delaunay.size() < repeats_max && total < enough_us)) {
    const Attempt attempt = system.run(graph, Depth::times);
    delaunay.push_back(attempt.delaunay_us);
    features.push_back(attempt.features_us);
    total += attempt.delaunay_us + attempt.features_us;
  }
  result.delaunay_us = spread_of(std::move(delaunay)).median;
  result.features_us = spread_of(std::move(features)).median;
}

Measurement measure_here(const System& system, const inputs::Graph& graph) {
  Measurement result;
  const Attempt whole = system.run(graph, Depth::whole);
  result.verdict = whole.verdict;
  if (result.verdict != Verdict::ok) return result;
  result.added = whole.added;
  result.added_after_pruning = whole.added_after_pruning;
  const files::Quality quality = quality_of(whole.image);
  result.edge_ratio = quality.mean_edge_ratio;
  result.radius_ratio = quality.mean_radius_ratio;
  result.survives_exchange = system.run(exchanged(graph), Depth::whole).hash == whole.hash;
  result.survives_shuffle =
      system.run(shuffled(graph, shuffle_seed), Depth::whole).hash == whole.hash;
  time_repeatedly(system, graph, result);
  return result;
}

}  // namespace

Measurement measure(const System& system, const inputs::Graph& graph,
                    std::chrono::milliseconds limit) {
  return bench::run_limited(limit, [&] { return measure_here(system, graph); })
      .value_or(Measurement{});
}

files::Quality delaunay_quality(const inputs::Graph& graph) {
  inputs::OwnedMesh mesh(inputs::config_for(graph, 0));
  if (mesh->build(graph.nodes, {}) != Status::ok) return {};
  return quality_of(files::image_of(*mesh, Exterior::hull, {}));
}

double gain_per_point(double refined, double constrained, std::uint32_t added) {
  return added == 0 ? 0 : (refined - constrained) / added;
}

}  // namespace etcm::compare
