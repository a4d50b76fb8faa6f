#include "compare/experiment.h"

namespace etcm::compare {
namespace {

using inputs::FeatureLength;

double total_work(const ExperimentPlan& plan) {
  double nodes = 0;
  for (const std::size_t size : plan.sizes) nodes += static_cast<double>(size);
  return 2 * nodes * static_cast<double>(plan.seeds);
}

}  // namespace

std::vector<std::size_t> standard_sizes() {
  return {60, 100, 150, 200, 300, 400, 600, 800, 1000, 1500, 2000, 2500, 3000, 4000, 5000};
}

Results run_experiment(const ExperimentPlan& plan, const Report& report) {
  Results results;
  const double total = total_work(plan);
  double done = 0;
  for (std::uint64_t seed = 1; seed <= plan.seeds; ++seed) {
    for (const std::size_t size : plan.sizes) {
      for (const FeatureLength length : {FeatureLength::any, FeatureLength::in_reach}) {
        const inputs::Graph graph = inputs::random_graph(size, length, seed);
        report(done / total, graph.name);
        GraphResult& result = results.graphs.emplace_back();
        result.length = length;
        result.nodes = size;
        result.seed = seed;
        result.features = graph.features.size();
        result.delaunay = delaunay_quality(graph);
        for (const System& system : all_systems()) {
          result.measured.push_back(measure(system, graph, plan.limit));
        }
        done += static_cast<double>(size);
      }
    }
  }
  report(1, "");
  return results;
}

}  // namespace etcm::compare
