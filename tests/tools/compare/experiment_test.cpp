// The experiment in small, with what must come out of it at any size.
#include "compare/experiment.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "compare/report/mesh_panels.h"
#include "compare/report/tables.h"

namespace etcm::compare {
namespace {

class Experiment : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    results_ = run_experiment({.sizes = {60, 150, 300}, .seeds = 1},
                              [](double done, const std::string&) { shares_.push_back(done); });
  }
  static const Measurement& of(const GraphResult& graph, std::string_view key) {
    return graph.measured[index_of_system(key)];
  }
  static Results results_;
  static std::vector<double> shares_;
};
Results Experiment::results_;
std::vector<double> Experiment::shares_;

TEST_F(Experiment, MeasuresEverySystemOnEveryGraph) {
  ASSERT_EQ(results_.graphs.size(), 6u);
  for (const GraphResult& graph : results_.graphs) {
    ASSERT_EQ(graph.measured.size(), all_systems().size());
    EXPECT_EQ(graph.features, graph.nodes * 15 / 100);
    for (const Measurement& measured : graph.measured) {
      EXPECT_EQ(measured.verdict, Verdict::ok);
      EXPECT_GT(measured.delaunay_us, 0);
      EXPECT_GT(measured.edge_ratio, 0.2);
      EXPECT_LT(measured.radius_ratio, 0.5);
    }
  }
}

TEST_F(Experiment, OursIsStableAndWeiIsNot) {
  bool wei_changed = false;
  for (const GraphResult& graph : results_.graphs) {
    EXPECT_TRUE(of(graph, ours_key).survives_exchange);
    EXPECT_TRUE(of(graph, ours_key).survives_shuffle);
    EXPECT_TRUE(of(graph, "etcm").survives_exchange);
    wei_changed = wei_changed || !of(graph, "wei").survives_exchange;
  }
  EXPECT_TRUE(wei_changed);
}

TEST_F(Experiment, OursAddsFewerPointsThanAnyOther) {
  const auto total = [](std::string_view key) {
    std::uint32_t sum = 0;
    for (const GraphResult& graph : results_.graphs) sum += of(graph, key).added;
    return sum;
  };
  for (const System& system : all_systems()) {
    if (system.conforms && system.key != ours_key) {
      EXPECT_LT(total(ours_key), total(system.key)) << system.label;
    }
  }
}

TEST_F(Experiment, TheBaselineAddsNothing) {
  for (const GraphResult& graph : results_.graphs) {
    EXPECT_EQ(of(graph, constrained_key).added, 0u);
  }
}

TEST_F(Experiment, ProgressOnlyGrows) {
  EXPECT_TRUE(std::is_sorted(shares_.begin(), shares_.end()));
  EXPECT_EQ(shares_.back(), 1);
}

TEST_F(Experiment, WritesARowForEachRunAndSummary) {
  const auto lines = [](const std::string& text) {
    return std::count(text.begin(), text.end(), '\n');
  };
  const auto systems = static_cast<std::ptrdiff_t>(all_systems().size());
  const auto readings = static_cast<std::ptrdiff_t>(other_readings().size());
  EXPECT_EQ(lines(runs_csv(results_)), 1 + 6 * (systems + readings));
  EXPECT_EQ(lines(summary_csv(results_)), 1 + 2 * 3 * systems);
  const std::string tables = experiment_tables(results_);
  for (const System& system : all_systems()) {
    EXPECT_NE(tables.find("| " + std::string(system.label)), std::string::npos);
  }
  for (const System& system : other_readings()) {
    EXPECT_NE(tables.find("`" + std::string(system.key) + "`"), std::string::npos);
  }
  EXPECT_NE(tables.find("24 graphs with one feature"), std::string::npos);
  EXPECT_EQ(results_.judgments.size(), 6u);
}

TEST(MeshPanels, HoldAPanelForEachSystem) {
  const std::string page = mesh_panels(inputs::random_graph(60, inputs::FeatureLength::any, 1));
  for (const System& system : all_systems()) {
    EXPECT_NE(page.find(std::string(system.label)), std::string::npos);
  }
  EXPECT_NE(page.find("stroke-dasharray"), std::string::npos);
}

}  // namespace
}  // namespace etcm::compare
