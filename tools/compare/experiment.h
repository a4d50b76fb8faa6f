// The experiment of the paper's section 6: every system on random graphs of many sizes.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "compare/results.h"

namespace etcm::compare {

struct ExperimentPlan {
  std::vector<std::size_t> sizes;           // nodes
  std::size_t seeds = 10;                   // graphs of each size: seeds 1, 2, ...
  std::size_t reading_seeds = 2;            // of these, those on which other readings are run too
  std::size_t lone_seeds = 8;               // graphs of each size with one feature
  std::chrono::milliseconds limit{60'000};  // for all that one system does with one graph
};

// The fifteen sizes: the paper has fifteen graphs and names only the smallest.
std::vector<std::size_t> standard_sizes();

// Tells what comes next: the share done, in [0, 1], and the graph.
using Report = std::function<void(double done, const std::string& what)>;

// Both readings of the feature length, all systems, and the paper's sections 4 and 5. Seeds are the
// outer loop, so that whatever else the machine does falls on all sizes and systems alike.
Results run_experiment(const ExperimentPlan& plan, const Report& report);

}  // namespace etcm::compare
