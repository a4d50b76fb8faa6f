#include "compare/experiment.h"

#include <algorithm>

namespace etcm::compare {
namespace {

using inputs::FeatureLength;

// What one seed takes of all sizes, in nodes: a measurement of all systems is the unit.
constexpr double share_of_readings = 1;
constexpr double share_of_lone = 0.2;

class ExperimentRun {
 public:
  ExperimentRun(const ExperimentPlan& plan, const Report& report) : plan_(plan), report_(report) {
    for (const std::size_t size : plan.sizes) nodes_ += static_cast<double>(size);
  }

  Results run() {
    for (std::uint64_t seed = 1; seed <= plan_.seeds; ++seed) {
      for (const std::size_t size : plan_.sizes) {
        for (const FeatureLength length : feature_lengths) measure_graph(size, length, seed);
      }
    }
    for (std::uint64_t seed = 1; seed <= plan_.lone_seeds; ++seed) {
      for (const std::size_t size : plan_.sizes) {
        tell("one feature of " + std::to_string(size) + " nodes");
        results_.only_vertex.push_back(measure_lone(size, seed));
        done_ += share_of_lone * static_cast<double>(size);
      }
    }
    report_(1, "");
    return std::move(results_);
  }

 private:
  void tell(const std::string& what) const {
    const double total =
        nodes_ *
        (2 * static_cast<double>(plan_.seeds) +
         2 * share_of_readings * static_cast<double>(std::min(plan_.seeds, plan_.reading_seeds)) +
         share_of_lone * static_cast<double>(plan_.lone_seeds));
    report_(done_ / total, what);
  }

  void measure_graph(std::size_t size, FeatureLength length, std::uint64_t seed) {
    const inputs::Graph graph = inputs::random_graph(size, length, seed);
    tell(graph.name);
    GraphResult& result = results_.graphs.emplace_back();
    result.length = length;
    result.nodes = size;
    result.seed = seed;
    result.features = graph.features.size();
    result.delaunay = delaunay_quality(graph);
    for (const System& system : all_systems()) {
      result.measured.push_back(measure(system, graph, plan_.limit));
    }
    done_ += static_cast<double>(size);
    if (seed > plan_.reading_seeds) return;
    for (const System& system : other_readings()) {
      result.readings.push_back(measure(system, graph, plan_.limit));
    }
    add_judgments(graph, length);
    done_ += share_of_readings * static_cast<double>(size);
  }

  void add_judgments(const inputs::Graph& graph, FeatureLength length) {
    auto found = std::find_if(results_.judgments.begin(), results_.judgments.end(),
                              [&](const JudgmentResult& row) {
                                return row.length == length && row.nodes == graph.nodes.size();
                              });
    if (found == results_.judgments.end()) {
      found = results_.judgments.insert(
          found, {.length = length, .nodes = graph.nodes.size(), .graphs = 0, .tally = {}});
    }
    ++found->graphs;
    found->tally += count_judgments(graph);
  }

  const ExperimentPlan& plan_;
  const Report& report_;
  Results results_;
  double nodes_ = 0;
  double done_ = 0;
};

}  // namespace

std::vector<std::size_t> standard_sizes() {
  return {60, 100, 150, 200, 300, 400, 600, 800, 1000, 1500, 2000, 2500, 3000, 4000, 5000};
}

Results run_experiment(const ExperimentPlan& plan, const Report& report) {
  return ExperimentRun(plan, report).run();
}

}  // namespace etcm::compare
