// What an experiment found, and what is made of it for tables and plots.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "compare/judgments.h"
#include "compare/lone.h"
#include "compare/measurement.h"
#include "compare/statistics.h"
#include "inputs/random_graph.h"

namespace etcm::compare {

struct GraphResult {
  inputs::FeatureLength length = inputs::FeatureLength::any;
  std::size_t nodes = 0;
  std::size_t features = 0;
  std::uint64_t seed = 0;
  files::Quality delaunay;
  std::vector<Measurement> measured;  // in the order of all_systems()
  std::vector<Measurement> readings;  // of other_readings(); empty where they were not asked
};

struct JudgmentResult {
  inputs::FeatureLength length = inputs::FeatureLength::any;
  std::size_t nodes = 0;
  std::size_t graphs = 0;
  JudgmentTally tally;  // over all of them
};

struct Results {
  std::vector<GraphResult> graphs;
  std::vector<LoneResult> only_vertex;
  std::vector<JudgmentResult> judgments;
};

// Both readings of how long the paper's features are.
inline constexpr inputs::FeatureLength feature_lengths[] = {inputs::FeatureLength::any,
                                                            inputs::FeatureLength::in_reach};

std::size_t index_of_system(std::string_view key);
const char* to_string(inputs::FeatureLength length) noexcept;

// One system on the graphs of one size and feature length; its failures are counted and left out of
// everything else.
struct Summary {
  std::size_t graphs = 0;
  std::size_t failed = 0;
  std::size_t survived_exchange = 0;
  std::size_t survived_shuffle = 0;
  double features = 0;  // median
  Spread added;
  Spread added_after_pruning;
  Spread delaunay_us;
  Spread features_us;
  Spread edge_ratio;
  Spread radius_ratio;
  Spread edge_gain;  // equation (3) with the edge ratio
  Spread radius_gain;
};
Summary summarize(const Results& results, inputs::FeatureLength length, std::size_t nodes,
                  std::size_t system);

// The sizes that occur, ascending.
std::vector<std::size_t> sizes_of(const Results& results);

// A row for each graph and system, other readings where they were asked, and one for each size,
// feature length and system.
std::string runs_csv(const Results& results);
std::string summary_csv(const Results& results);

}  // namespace etcm::compare
