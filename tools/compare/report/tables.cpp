#include "compare/report/tables.h"

#include <cmath>
#include <sstream>

#include "compare/report/reading_tables.h"
#include "compare/report/standing.h"
#include "compare/report/table_text.h"

namespace etcm::compare {
namespace {

using inputs::FeatureLength;

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
    out << "| " << system.label << " | " << s.failed << " | "
        << share(s.survived_exchange, s.good()) << " | " << share(s.survived_shuffle, s.good())
        << " | " << decimal(s.points_per_feature(), 2) << " | "
        << (system.conforms ? decimal(s.added / std::max(1.0, s.ours_added), 3) : "-") << " | "
        << (at_largest.failed == at_largest.graphs
                ? "-"
                : decimal(at_largest.features_us.median / 1000, 2))
        << " | " << decimal(s.time_times_ours(), 2) << " | "
        << decimal(undulation(results, length, i), 2) << " | " << decimal(s.mean(s.edge_ratio), 4)
        << " | " << decimal(s.mean(s.radius_ratio), 4) << " | ";
    if (system.conforms) {
      out << decimal(s.edge_gain_per_thousand(), 4) << " | "
          << decimal(s.radius_gain_per_thousand(), 4) << " |\n";
    } else {
      out << "baseline | baseline |\n";
    }
  }
}

// One system on one feature length.
struct Figures {
  Standing standing;
  double undulation = 0;
  double residual = 0;
};

struct Criterion {
  const char* name;
  int digits;
  bool less_is_better;
  double (*value)(const Figures& figures);
};

constexpr Criterion criteria[] = {
    {"1 same mesh, ends exchanged (share)", 3, false,
     [](const Figures& f) {
       return f.standing.mean(static_cast<double>(f.standing.survived_exchange));
     }},
    {"1 same mesh, order shuffled (share)", 3, false,
     [](const Figures& f) {
       return f.standing.mean(static_cast<double>(f.standing.survived_shuffle));
     }},
    {"2 points per feature", 2, true,
     [](const Figures& f) { return f.standing.points_per_feature(); }},
    {"3 time, times ours", 2, true, [](const Figures& f) { return f.standing.time_times_ours(); }},
    {"3 undulation at one size", 3, true, [](const Figures& f) { return f.undulation; }},
    {"3 residual about a line", 3, true, [](const Figures& f) { return f.residual; }},
    {"4 AAR (edges)", 4, false,
     [](const Figures& f) { return f.standing.mean(f.standing.edge_ratio); }},
    {"4 AAR (radii)", 4, false,
     [](const Figures& f) { return f.standing.mean(f.standing.radius_ratio); }},
    {"5 AAR gain per 1000 points (edges)", 4, false,
     [](const Figures& f) { return f.standing.edge_gain_per_thousand(); }},
    {"5 AAR gain per 1000 points (radii)", 4, false,
     [](const Figures& f) { return f.standing.radius_gain_per_thousand(); }},
};

// A row for each criterion: ours against the best of the other conforming systems.
void write_lead(std::ostream& out, const Results& results, FeatureLength length) {
  out << "| criterion | ours | best other | ours is |\n|---|---:|---:|---|\n";
  const auto compared = all_systems();
  std::vector<Figures> figures;
  for (std::size_t i = 0; i < compared.size(); ++i) {
    figures.push_back({standing_of(results, length, i), undulation(results, length, i),
                       fits_of(results, length, i).seed_residual});
  }
  const std::size_t ours = index_of_system(ours_key);
  for (const Criterion& criterion : criteria) {
    const auto value = [&](std::size_t i) { return criterion.value(figures[i]); };
    std::size_t best = ours;
    for (std::size_t i = 0; i < compared.size(); ++i) {
      if (i == ours || !compared[i].conforms || figures[i].standing.good() == 0) continue;
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
    for (const FeatureLength length : feature_lengths) {
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

void write_linearity(std::ostream& out, const Results& results, FeatureLength length) {
  out << "| system | µs per node | R² | residual | residual, one graph a size | time grows as | "
         "points per feature | R² | residual |\n"
         "|---|---:|---:|---:|---:|---:|---:|---:|---:|\n";
  for (std::size_t i = 0; i < all_systems().size(); ++i) {
    if (!all_systems()[i].conforms) continue;
    const auto [time, points, exponent, seed_residual] = fits_of(results, length, i);
    out << "| " << all_systems()[i].label << " | " << decimal(time.slope, 3) << " | "
        << decimal(time.r_squared, 4) << " | " << decimal(100 * time.relative_residual, 1)
        << " % | " << decimal(100 * seed_residual, 1) << " % | nodes^" << decimal(exponent, 2)
        << " | " << decimal(points.slope, 2) << " | " << decimal(points.r_squared, 4) << " | "
        << decimal(100 * points.relative_residual, 1) << " % |\n";
  }
}

}  // namespace

std::string experiment_tables(const Results& results) {
  std::ostringstream out;
  for (const FeatureLength length : feature_lengths) {
    out << "### The five criteria, " << to_string(length) << " features\n\n";
    write_criteria(out, results, length);
    out << '\n' << delaunay_line(results, length) << '\n';
    out << "### Ours against the best of the others, " << to_string(length) << " features\n\n";
    write_lead(out, results, length);
    out << '\n';
  }
  out << "### What pruning would take out of each, all graphs together\n\n";
  write_pruning(out, results);
  for (const FeatureLength length : feature_lengths) {
    out << "\n### Straight lines through the medians of each size, " << to_string(length)
        << " features\n\n";
    write_linearity(out, results, length);
  }
  out << '\n' << reading_tables(results);
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
