#include "compare/measurement.h"

#include <algorithm>

#include "bench/limited.h"
#include "compare/variants.h"
#include "inputs/owned_mesh.h"

namespace etcm::compare {
namespace {

constexpr std::uint64_t shuffle_seed = 2015;

// Small graphs take microseconds: there are many repeats before they take long together.
constexpr int repeats_min = 5;
constexpr int repeats_max = 40;
constexpr double enough_us = 40'000;

void time_repeatedly(const System& system, const inputs::Graph& graph, Measurement& result) {
  double delaunay = 0;
  double total = 0;
  double spent = 0;
  for (int run = 0; run < repeats_min || (run < repeats_max && spent < enough_us); ++run) {
    const Attempt attempt = system.run(graph, Depth::times);
    delaunay = run == 0 ? attempt.delaunay_us : std::min(delaunay, attempt.delaunay_us);
    total = run == 0 ? attempt.total_us : std::min(total, attempt.total_us);
    spent += attempt.total_us;
  }
  result.delaunay_us = delaunay;
  result.features_us = std::max(0.0, total - delaunay);
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
