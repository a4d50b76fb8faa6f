#include "compare/report/reading_tables.h"

#include <algorithm>
#include <sstream>

#include "compare/report/standing.h"
#include "compare/report/table_text.h"

namespace etcm::compare {
namespace {

using inputs::FeatureLength;

void write_reading(std::ostream& out, const System& system, const Standing& s,
                   double etcm_time_times_ours) {
  out << "| " << system.label << " | `" << system.key << "` | ";
  if (s.good() == 0) {
    out << "fails | | | | | | |\n";
    return;
  }
  out << share(s.survived_exchange, s.graphs) << " | " << share(s.survived_shuffle, s.graphs)
      << " | " << decimal(s.points_per_feature(), 2) << " | "
      << decimal(s.time_times_ours() / etcm_time_times_ours, 2) << " | "
      << decimal(s.mean(s.edge_ratio), 4) << " | " << decimal(s.mean(s.radius_ratio), 4) << " | "
      << decimal(s.edge_gain_per_thousand(), 4) << " |\n";
}

void write_readings(std::ostream& out, const Results& results, FeatureLength length) {
  out << "| system | key | same mesh, ends exchanged | same mesh, order shuffled | points per "
         "feature | time, times ETCM's | AAR (edges) | AAR (radii) | AAR gain per 1000 points "
         "(edges) |\n|---|---|---:|---:|---:|---:|---:|---:|---:|\n";
  const auto standing_where_read = [&](std::size_t system) {
    return standing_of(results, length, [system](const GraphResult& graph) {
      return graph.readings.empty() ? nullptr : &graph.measured[system];
    });
  };
  const std::size_t etcm = index_of_system(etcm_key);
  const double etcm_time = standing_where_read(etcm).time_times_ours();
  for (std::size_t i = 0; i <= etcm; ++i) {
    write_reading(out, all_systems()[i], standing_where_read(i), etcm_time);
  }
  for (std::size_t i = 0; i < other_readings().size(); ++i) {
    const Standing standing = standing_of(results, length, [i](const GraphResult& graph) {
      return graph.readings.empty() ? nullptr : &graph.readings[i];
    });
    write_reading(out, other_readings()[i], standing, etcm_time);
  }
}

void write_lone(std::ostream& out, const Results& results) {
  std::uint64_t least = 0;
  for (const LoneResult& only_vertex : results.only_vertex) least += only_vertex.least;
  out << "| system | points | times the least | the least on |\n|---|---:|---:|---:|\n| the least "
         "there is, from the nodes | "
      << least << " | 1.000 | all |\n";
  const std::vector<System> systems = lone_systems();
  for (std::size_t i = 0; i < systems.size(); ++i) {
    std::uint64_t points = 0;
    std::size_t failed = 0, at_least = 0;
    for (const LoneResult& only_vertex : results.only_vertex) {
      failed += only_vertex.added[i] == lone_failed;
      points += only_vertex.added[i];
      at_least += only_vertex.added[i] == only_vertex.least;
    }
    out << "| " << systems[i].label << " | ";
    if (failed > 0) {
      out << "fails | | |\n";
      continue;
    }
    out << points << " | "
        << decimal(
               static_cast<double>(points) / static_cast<double>(std::max<std::uint64_t>(least, 1)),
               3)
        << " | " << share(at_least, results.only_vertex.size()) << " |\n";
  }
}

double mean(std::uint64_t sum, std::uint64_t count) {
  return count == 0 ? 0 : static_cast<double>(sum) / static_cast<double>(count);
}

void write_judgments(std::ostream& out, const Results& results) {
  out << "| features | nodes | times that a feature is treated | triangles at its end | crossed: n "
         "| "
         "judgments counted | 6 + (n - 2)·2 | points | crossed: n | judgments counted | n - 1 | "
         "all "
         "judgments per node |\n|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n";
  const std::vector<std::size_t> sizes = sizes_of(results);
  // Four sizes show how it grows.
  const std::size_t steps = std::min<std::size_t>(sizes.size() - 1, 3);
  for (const JudgmentResult& row : results.judgments) {
    const auto at = std::find(sizes.begin(), sizes.end(), row.nodes) - sizes.begin();
    bool is_shown = false;
    for (std::size_t step = 0; step <= steps; ++step) {
      is_shown |= static_cast<std::size_t>(at) ==
                  step * (sizes.size() - 1) / std::max<std::size_t>(steps, 1);
    }
    if (!is_shown) continue;
    const JudgmentTally& t = row.tally;
    const double nodes = static_cast<double>(row.nodes * row.graphs);
    out << "| " << to_string(row.length) << " | " << row.nodes << " | " << t.subsegments << " | "
        << decimal(mean(t.around, t.subsegments), 2) << " | "
        << decimal(mean(t.crossed, t.subsegments), 2) << " | "
        << decimal(mean(t.intersections, t.subsegments), 2) << " | "
        << decimal(6 + 2 * (mean(t.crossed, t.subsegments) - 2), 2) << " | " << t.points << " | "
        << decimal(mean(t.searched, t.points), 2) << " | "
        << decimal(mean(t.containment, t.points), 2) << " | "
        << decimal(mean(t.searched, t.points) - 1, 2) << " | "
        << decimal(static_cast<double>(t.intersections + t.containment) / nodes, 2) << " |\n";
  }
}

}  // namespace

std::string reading_tables(const Results& results) {
  std::ostringstream out;
  const bool has_readings =
      std::any_of(results.graphs.begin(), results.graphs.end(),
                  [](const GraphResult& graph) { return !graph.readings.empty(); });
  if (has_readings) {
    for (const FeatureLength length : feature_lengths) {
      out << "### Other readings of the paper, " << to_string(length) << " features\n\n";
      write_readings(out, results, length);
      out << '\n';
    }
  }
  if (!results.only_vertex.empty()) {
    out << "### A feature alone: " << results.only_vertex.size() << " graphs with one feature\n\n";
    write_lone(out, results);
    out << '\n';
  }
  if (!results.judgments.empty()) {
    out << "### Judgments of section 5, ETCM (literal)\n\n";
    write_judgments(out, results);
  }
  return out.str();
}

}  // namespace etcm::compare
