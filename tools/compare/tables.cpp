#include "compare/tables.h"

#include <cmath>
#include <iomanip>
#include <sstream>

namespace etcm::compare {
namespace {

using inputs::FeatureLength;

std::string decimal(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

std::string share(std::size_t part, std::size_t whole) {
  return part == whole ? "all" : std::to_string(part) + " of " + std::to_string(whole);
}

// Everything of one system and feature length, against ours on the same graphs.
struct Standing {
  std::size_t graphs = 0;
  std::size_t failed = 0;
  std::size_t survived_exchange = 0;
  std::size_t survived_shuffle = 0;
  double features = 0;
  double added = 0;
  double added_after_pruning = 0;
  double ours_added = 0;
  double log_time_ratio = 0;
  double edge_ratio = 0;
  double radius_ratio = 0;
  double edge_over_constrained = 0;  // summed gains of AAR
  double radius_over_constrained = 0;
  std::size_t good() const { return graphs - failed; }
  double mean(double sum) const { return good() == 0 ? 0 : sum / static_cast<double>(good()); }
};

Standing standing_of(const Results& results, FeatureLength length, std::size_t system) {
  Standing standing;
  const std::size_t ours = index_of_system(ours_key);
  const std::size_t baseline = index_of_system(constrained_key);
  for (const GraphResult& graph : results.graphs) {
    if (graph.length != length) continue;
    ++standing.graphs;
    const Measurement& measured = graph.measured[system];
    if (measured.verdict != Verdict::ok) {
      ++standing.failed;
      continue;
    }
    standing.survived_exchange += measured.survives_exchange;
    standing.survived_shuffle += measured.survives_shuffle;
    standing.features += static_cast<double>(graph.features);
    standing.added += measured.added;
    standing.added_after_pruning += measured.added_after_pruning;
    standing.ours_added += graph.measured[ours].added;
    // A microsecond more on both sides, for a clock that saw nothing.
    standing.log_time_ratio +=
        std::log((measured.features_us + 1) / (graph.measured[ours].features_us + 1));
    standing.edge_ratio += measured.edge_ratio;
    standing.radius_ratio += measured.radius_ratio;
    standing.edge_over_constrained += measured.edge_ratio - graph.measured[baseline].edge_ratio;
    standing.radius_over_constrained +=
        measured.radius_ratio - graph.measured[baseline].radius_ratio;
  }
  return standing;
}

// The paper's "undulation": quartile distance of the times of one size over their median, averaged
// over the sizes.
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

void write_criteria(std::ostream& out, const Results& results, FeatureLength length) {
  const std::size_t largest = sizes_of(results).back();
  out << "| system | failed | same mesh, ends exchanged | same mesh, order shuffled | points per "
         "feature | points, times ours | ms at "
      << largest
      << " nodes | time, times ours | undulation | AAR (edges) | AAR (radii) | AAR gain per 1000 "
         "points (edges) | (radii) |\n|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|"
         "---:|\n";
  for (std::size_t i = 0; i < all_systems().size(); ++i) {
    const System& system = all_systems()[i];
    const Standing s = standing_of(results, length, i);
    if (s.good() == 0) {
      out << "| " << system.label << " | all | | | | | | | | | | | |\n";
      continue;
    }
    const Summary at_largest = summarize(results, length, largest, i);
    const double thousand = s.added > 0 ? 1000 / s.added : 0;
    out << "| " << system.label << " | " << s.failed << " | "
        << share(s.survived_exchange, s.good()) << " | " << share(s.survived_shuffle, s.good())
        << " | " << decimal(s.added / s.features, 2) << " | "
        << (system.conforms ? decimal(s.added / std::max(1.0, s.ours_added), 3) : "-") << " | "
        << (at_largest.failed == at_largest.graphs
                ? "-"
                : decimal(at_largest.features_us.median / 1000, 2))
        << " | " << decimal(std::exp(s.mean(s.log_time_ratio)), 2) << " | "
        << decimal(undulation(results, length, i), 2) << " | " << decimal(s.mean(s.edge_ratio), 4)
        << " | " << decimal(s.mean(s.radius_ratio), 4) << " | ";
    if (system.conforms) {
      out << decimal(s.edge_over_constrained * thousand, 4) << " | "
          << decimal(s.radius_over_constrained * thousand, 4) << " |\n";
    } else {
      out << "baseline | baseline |\n";
    }
  }
}

struct Criterion {
  const char* name;
  int digits;
  bool less_is_better;
  double (*value)(const Standing& standing, double undulation);
};

constexpr Criterion criteria[] = {
    {"1 same mesh, ends exchanged (share)", 3, false,
     [](const Standing& s, double) { return s.mean(static_cast<double>(s.survived_exchange)); }},
    {"1 same mesh, order shuffled (share)", 3, false,
     [](const Standing& s, double) { return s.mean(static_cast<double>(s.survived_shuffle)); }},
    {"2 points per feature", 2, true,
     [](const Standing& s, double) { return s.added / s.features; }},
    {"3 time, times ours", 2, true,
     [](const Standing& s, double) { return std::exp(s.mean(s.log_time_ratio)); }},
    {"3 undulation", 3, true, [](const Standing&, double undulation) { return undulation; }},
    {"4 AAR (edges)", 4, false, [](const Standing& s, double) { return s.mean(s.edge_ratio); }},
    {"4 AAR (radii)", 4, false, [](const Standing& s, double) { return s.mean(s.radius_ratio); }},
    {"5 AAR gain per 1000 points (edges)", 4, false,
     [](const Standing& s, double) { return 1000 * s.edge_over_constrained / s.added; }},
    {"5 AAR gain per 1000 points (radii)", 4, false,
     [](const Standing& s, double) { return 1000 * s.radius_over_constrained / s.added; }},
};

// A row for each criterion: ours against the best of the other conforming systems.
void write_lead(std::ostream& out, const Results& results, FeatureLength length) {
  out << "| criterion | ours | best other | ours is |\n|---|---:|---:|---|\n";
  const auto compared = all_systems();
  std::vector<Standing> standings;
  std::vector<double> undulations;
  for (std::size_t i = 0; i < compared.size(); ++i) {
    standings.push_back(standing_of(results, length, i));
    undulations.push_back(undulation(results, length, i));
  }
  const std::size_t ours = index_of_system(ours_key);
  for (const Criterion& criterion : criteria) {
    const auto value = [&](std::size_t i) { return criterion.value(standings[i], undulations[i]); };
    std::size_t best = ours;
    for (std::size_t i = 0; i < compared.size(); ++i) {
      if (i == ours || !compared[i].conforms || standings[i].good() == 0) continue;
      const bool is_better =
          criterion.less_is_better ? value(i) < value(best) : value(i) > value(best);
      if (best == ours || is_better) best = i;
    }
    const double lead =
        (criterion.less_is_better ? value(best) - value(ours) : value(ours) - value(best)) /
        value(best);
    out << "| " << criterion.name << " | " << decimal(value(ours), criterion.digits) << " | "
        << compared[best].label << ", " << decimal(value(best), criterion.digits) << " | ";
    if (value(ours) == value(best)) {
      out << "level |\n";
    } else {
      out << (lead > 0 ? "ahead by " : "**behind** by ") << decimal(100 * std::abs(lead), 1)
          << " % |\n";
    }
  }
}

std::string delaunay_line(const Results& results, FeatureLength length) {
  double edges = 0, radii = 0, count = 0;
  for (const GraphResult& graph : results.graphs) {
    if (graph.length != length) continue;
    edges += graph.delaunay.mean_edge_ratio;
    radii += graph.delaunay.mean_radius_ratio;
    count += 1;
  }
  return "AAR of the nodes' Delaunay mesh, before any feature: " + decimal(edges / count, 4) +
         " (edges), " + decimal(radii / count, 4) + " (radii).\n";
}

void write_pruning(std::ostream& out, const Results& results) {
  out << "| system | long: points | after our pruning | short: points | after our pruning |\n"
         "|---|---:|---:|---:|---:|\n";
  for (std::size_t i = 0; i < all_systems().size(); ++i) {
    if (!all_systems()[i].conforms) continue;
    out << "| " << all_systems()[i].label;
    for (const FeatureLength length : {FeatureLength::any, FeatureLength::in_reach}) {
      const Standing s = standing_of(results, length, i);
      out << " | " << decimal(s.added, 0) << " | "
          << (s.added == s.added_after_pruning
                  ? "-"
                  : decimal(s.added_after_pruning, 0) + " (" +
                        decimal(100 * (s.added_after_pruning / s.added - 1), 1) + " %)");
    }
    out << " |\n";
  }
}

struct Fits {
  Line time;    // of inserting the features, in microseconds, against nodes
  Line points;  // against features
  // The power of the nodes with which the time grows: the slope of the logarithms.
  double time_exponent = 0;
};

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
  return {fit_line(nodes, times), fit_line(features, points), fit_line(log_nodes, log_times).slope};
}

void write_linearity(std::ostream& out, const Results& results, FeatureLength length) {
  out << "| system | µs per node | R² | residual | time grows as | points per feature | R² | "
         "residual |\n"
         "|---|---:|---:|---:|---:|---:|---:|---:|\n";
  for (std::size_t i = 0; i < all_systems().size(); ++i) {
    if (!all_systems()[i].conforms) continue;
    const auto [time, points, exponent] = fits_of(results, length, i);
    out << "| " << all_systems()[i].label << " | " << decimal(time.slope, 3) << " | "
        << decimal(time.r_squared, 4) << " | " << decimal(100 * time.relative_residual, 1)
        << " % | nodes^" << decimal(exponent, 2) << " | " << decimal(points.slope, 2) << " | "
        << decimal(points.r_squared, 4) << " | " << decimal(100 * points.relative_residual, 1)
        << " % |\n";
  }
}

}  // namespace

std::string experiment_tables(const Results& results) {
  std::ostringstream out;
  for (const FeatureLength length : {FeatureLength::any, FeatureLength::in_reach}) {
    out << "### The five criteria, " << to_string(length) << " features\n\n";
    write_criteria(out, results, length);
    out << '\n' << delaunay_line(results, length) << '\n';
    out << "### Ours against the best of the others, " << to_string(length) << " features\n\n";
    write_lead(out, results, length);
    out << '\n';
  }
  out << "### What pruning would take out of each, all graphs together\n\n";
  write_pruning(out, results);
  for (const FeatureLength length : {FeatureLength::any, FeatureLength::in_reach}) {
    out << "\n### Straight lines through the medians of each size, " << to_string(length)
        << " features\n\n";
    write_linearity(out, results, length);
  }
  return out.str();
}

std::string graph_table(std::span<const System> systems, std::span<const Measurement> measured) {
  const Measurement* baseline = nullptr;
  for (std::size_t i = 0; i < systems.size(); ++i) {
    if (systems[i].key == constrained_key && measured[i].verdict == Verdict::ok) {
      baseline = &measured[i];
    }
  }
  std::ostringstream out;
  out << "| system | verdict | ends exchanged | order shuffled | points | after pruning | Delaunay "
         "ms | features ms | AAR (edges) | AAR (radii) | AAR gain per 1000 points |\n"
         "|---|---|---|---|---:|---:|---:|---:|---:|---:|---:|\n";
  for (std::size_t i = 0; i < systems.size(); ++i) {
    const Measurement& m = measured[i];
    out << "| " << systems[i].label << " | " << to_string(m.verdict) << " | ";
    if (m.verdict != Verdict::ok) {
      out << "| | | | | | | | |\n";
      continue;
    }
    out << (m.survives_exchange ? "same" : "changes") << " | "
        << (m.survives_shuffle ? "same" : "changes") << " | " << m.added << " | "
        << m.added_after_pruning << " | " << decimal(m.delaunay_us / 1000, 3) << " | "
        << decimal(m.features_us / 1000, 3) << " | " << decimal(m.edge_ratio, 4) << " | "
        << decimal(m.radius_ratio, 4) << " | "
        << (baseline == nullptr || !systems[i].conforms
                ? "-"
                : decimal(1000 * gain_per_point(m.edge_ratio, baseline->edge_ratio, m.added), 4))
        << " |\n";
  }
  return out.str();
}

}  // namespace etcm::compare
