#include "compare/report/standing.h"

#include <map>

namespace etcm::compare {
namespace {

using inputs::FeatureLength;

double residual_of_seeds(const Results& results, FeatureLength length, std::size_t system) {
  struct Curve {
    std::vector<double> nodes;
    std::vector<double> times;
  };
  std::map<std::uint64_t, Curve> curves;
  for (const GraphResult& graph : results.graphs) {
    const Measurement& measured = graph.measured[system];
    if (graph.length != length || measured.verdict != Verdict::ok) continue;
    curves[graph.seed].nodes.push_back(static_cast<double>(graph.nodes));
    curves[graph.seed].times.push_back(measured.features_us);
  }
  double sum = 0;
  for (const auto& [seed, curve] : curves) {
    if (curve.nodes.size() < 3) return 0;
    sum += fit_line(curve.nodes, curve.times).relative_residual;
  }
  return curves.empty() ? 0 : sum / static_cast<double>(curves.size());
}

}  // namespace

Standing standing_of(const Results& results, FeatureLength length, const Pick& pick) {
  Standing standing;
  const std::size_t ours = index_of_system(ours_key);
  const std::size_t baseline = index_of_system(constrained_key);
  for (const GraphResult& graph : results.graphs) {
    const Measurement* measured = graph.length == length ? pick(graph) : nullptr;
    if (measured == nullptr) continue;
    ++standing.graphs;
    if (measured->verdict != Verdict::ok) {
      ++standing.failed;
      continue;
    }
    standing.survived_exchange += measured->survives_exchange;
    standing.survived_shuffle += measured->survives_shuffle;
    standing.features += static_cast<double>(graph.features);
    standing.added += measured->added;
    standing.added_after_pruning += measured->added_after_pruning;
    standing.ours_added += graph.measured[ours].added;
    // A microsecond more on both sides, for a clock that saw nothing.
    standing.log_time_ratio +=
        std::log((measured->features_us + 1) / (graph.measured[ours].features_us + 1));
    standing.edge_ratio += measured->edge_ratio;
    standing.radius_ratio += measured->radius_ratio;
    standing.edge_over_constrained += measured->edge_ratio - graph.measured[baseline].edge_ratio;
    standing.radius_over_constrained +=
        measured->radius_ratio - graph.measured[baseline].radius_ratio;
  }
  return standing;
}

Standing standing_of(const Results& results, FeatureLength length, std::size_t system) {
  return standing_of(results, length,
                     [system](const GraphResult& graph) { return &graph.measured[system]; });
}

double undulation(const Results& results, FeatureLength length, std::size_t system) {
  double sum = 0;
  std::size_t sizes = 0;
  for (const std::size_t nodes : sizes_of(results)) {
    const Spread time = summarize(results, length, nodes, system).features_us;
    if (time.median <= 0) continue;
    sum += (time.upper - time.lower) / time.median;
    ++sizes;
  }
  return sizes == 0 ? 0 : sum / static_cast<double>(sizes);
}

Fits fits_of(const Results& results, FeatureLength length, std::size_t system) {
  std::vector<double> nodes, features, times, points;
  for (const std::size_t size : sizes_of(results)) {
    const Summary summary = summarize(results, length, size, system);
    if (summary.failed == summary.graphs) continue;
    nodes.push_back(static_cast<double>(size));
    features.push_back(summary.features);
    times.push_back(summary.features_us.median);
    points.push_back(summary.added.median);
  }
  if (nodes.size() < 3) return {};
  std::vector<double> log_nodes, log_times;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    log_nodes.push_back(std::log(nodes[i]));
    log_times.push_back(std::log(times[i] + 1));
  }
  return {fit_line(nodes, times), fit_line(features, points), fit_line(log_nodes, log_times).slope,
          residual_of_seeds(results, length, system)};
}

}  // namespace etcm::compare
