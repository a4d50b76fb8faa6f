// One system on all graphs of one feature length, summed up.
#pragma once

#include <cmath>
#include <functional>

#include "compare/results.h"

namespace etcm::compare {

// Sums over the graphs that it finished.
struct Standing {
  std::size_t graphs = 0;
  std::size_t failed = 0;
  std::size_t survived_exchange = 0;
  std::size_t survived_shuffle = 0;
  double features = 0;
  double added = 0;
  double added_after_pruning = 0;
  double ours_added = 0;
  double log_time_ratio = 0;  // its time against ours
  double edge_ratio = 0;
  double radius_ratio = 0;
  double edge_over_constrained = 0;  // gains of AAR
  double radius_over_constrained = 0;

  std::size_t good() const { return graphs - failed; }
  double mean(double sum) const { return good() == 0 ? 0 : sum / static_cast<double>(good()); }
  double points_per_feature() const { return added / features; }
  double time_times_ours() const { return std::exp(mean(log_time_ratio)); }
  // Equation (3), over all graphs together.
  double edge_gain_per_thousand() const { return per_thousand(edge_over_constrained); }
  double radius_gain_per_thousand() const { return per_thousand(radius_over_constrained); }

 private:
  double per_thousand(double gain) const { return added > 0 ? 1000 * gain / added : 0; }
};

// What is measured of the system on a graph; null where it was not asked.
using Pick = std::function<const Measurement*(const GraphResult&)>;
Standing standing_of(const Results& results, inputs::FeatureLength length, const Pick& pick);
// One of all_systems(), by its index.
Standing standing_of(const Results& results, inputs::FeatureLength length, std::size_t system);

// The paper's "undulation" where a size has several graphs: quartile distance of the times of one
// size over their median, averaged over the sizes.
double undulation(const Results& results, inputs::FeatureLength length, std::size_t system);

struct Fits {
  FittedLine
      time;  // of inserting the features, in microseconds, against nodes, medians of each size
  FittedLine points;  // against features
  // The power of the nodes with which the time grows: the slope of the logarithms.
  double time_exponent = 0;
  // The paper's figure 3 has one graph of each size: the relative residual of the time about a line
  // through the graphs of one seed, averaged over the seeds.
  double seed_residual = 0;
};
Fits fits_of(const Results& results, inputs::FeatureLength length, std::size_t system);

}  // namespace etcm::compare
