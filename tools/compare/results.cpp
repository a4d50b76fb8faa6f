#include "compare/results.h"

#include <algorithm>
#include <functional>
#include <set>
#include <sstream>

namespace etcm::compare {
namespace {

double edge_gain(const Measurement& measured, const Measurement& constrained) {
  return gain_per_point(measured.edge_ratio, constrained.edge_ratio, measured.added);
}

double radius_gain(const Measurement& measured, const Measurement& constrained) {
  return gain_per_point(measured.radius_ratio, constrained.radius_ratio, measured.added);
}

void write_spread(std::ostream& out, const Spread& spread) {
  out << ',' << spread.median << ',' << spread.lower << ',' << spread.upper;
}

void write_run(std::ostream& out, const GraphResult& graph, const System& system,
               const Measurement& measured, const Measurement& constrained) {
  out << to_string(graph.length) << ',' << graph.nodes << ',' << graph.features << ',' << graph.seed
      << ',' << system.key << ',' << to_string(measured.verdict) << ','
      << measured.survives_exchange << ',' << measured.survives_shuffle << ',' << measured.added
      << ',' << measured.added_after_pruning << ',' << measured.delaunay_us << ','
      << measured.features_us << ',' << measured.edge_ratio << ',' << measured.radius_ratio << ','
      << graph.delaunay.mean_edge_ratio << ',' << constrained.edge_ratio << ','
      << edge_gain(measured, constrained) << ',' << radius_gain(measured, constrained) << '\n';
}

}  // namespace

std::size_t index_of_system(std::string_view key) {
  const auto systems = all_systems();
  const auto found = std::find_if(systems.begin(), systems.end(),
                                  [key](const System& system) { return system.key == key; });
  return static_cast<std::size_t>(found - systems.begin());
}

const char* to_string(inputs::FeatureLength length) noexcept {
  return length == inputs::FeatureLength::any ? "long" : "short";
}

Summary summarize(const Results& results, inputs::FeatureLength length, std::size_t nodes,
                  std::size_t system) {
  Summary summary;
  const std::size_t baseline = index_of_system(constrained_key);
  std::vector<const GraphResult*> good;
  for (const GraphResult& graph : results.graphs) {
    if (graph.length != length || graph.nodes != nodes) continue;
    ++summary.graphs;
    const Measurement& measured = graph.measured[system];
    if (measured.verdict != Verdict::ok) {
      ++summary.failed;
      continue;
    }
    summary.survived_exchange += measured.survives_exchange;
    summary.survived_shuffle += measured.survives_shuffle;
    good.push_back(&graph);
  }
  const auto spread = [&](const std::function<double(const GraphResult&)>& value) {
    std::vector<double> values;
    for (const GraphResult* graph : good) values.push_back(value(*graph));
    return spread_of(std::move(values));
  };
  const auto member = [&](auto pointer) {
    return spread([=](const GraphResult& graph) {
      return static_cast<double>(graph.measured[system].*pointer);
    });
  };
  summary.features =
      spread([](const GraphResult& graph) { return static_cast<double>(graph.features); }).median;
  summary.added = member(&Measurement::added);
  summary.added_after_pruning = member(&Measurement::added_after_pruning);
  summary.delaunay_us = member(&Measurement::delaunay_us);
  summary.features_us = member(&Measurement::features_us);
  summary.edge_ratio = member(&Measurement::edge_ratio);
  summary.radius_ratio = member(&Measurement::radius_ratio);
  summary.edge_gain = spread([=](const GraphResult& graph) {
    return edge_gain(graph.measured[system], graph.measured[baseline]);
  });
  summary.radius_gain = spread([=](const GraphResult& graph) {
    return radius_gain(graph.measured[system], graph.measured[baseline]);
  });
  return summary;
}

std::vector<std::size_t> sizes_of(const Results& results) {
  std::set<std::size_t> sizes;
  for (const GraphResult& graph : results.graphs) sizes.insert(graph.nodes);
  return {sizes.begin(), sizes.end()};
}

std::string runs_csv(const Results& results) {
  std::ostringstream out;
  out << "features,nodes,feature_count,seed,system,verdict,same_after_exchange,"
         "same_after_shuffle,added,added_after_pruning,delaunay_us,features_us,aar_edge,"
         "aar_radius,aar_edge_delaunay,aar_edge_constrained,aar_edge_per_point,"
         "aar_radius_per_point\n";
  const std::size_t baseline = index_of_system(constrained_key);
  for (const GraphResult& graph : results.graphs) {
    const Measurement& constrained = graph.measured[baseline];
    for (std::size_t i = 0; i < graph.measured.size(); ++i) {
      write_run(out, graph, all_systems()[i], graph.measured[i], constrained);
    }
    for (std::size_t i = 0; i < graph.readings.size(); ++i) {
      write_run(out, graph, other_readings()[i], graph.readings[i], constrained);
    }
  }
  return out.str();
}

std::string summary_csv(const Results& results) {
  std::ostringstream out;
  out << "features,system,nodes,graphs,failed,same_after_exchange,same_after_shuffle,"
         "feature_count";
  for (const char* name : {"added", "added_after_pruning", "delaunay_us", "features_us", "aar_edge",
                           "aar_radius", "aar_edge_per_point", "aar_radius_per_point"}) {
    out << ',' << name << ',' << name << "_lower," << name << "_upper";
  }
  out << ",aar_edge_delaunay\n";
  for (const inputs::FeatureLength length : feature_lengths) {
    for (std::size_t i = 0; i < all_systems().size(); ++i) {
      for (const std::size_t nodes : sizes_of(results)) {
        const Summary summary = summarize(results, length, nodes, i);
        out << to_string(length) << ',' << all_systems()[i].key << ',' << nodes << ','
            << summary.graphs << ',' << summary.failed << ',' << summary.survived_exchange << ','
            << summary.survived_shuffle << ',' << summary.features;
        for (const Spread& spread :
             {summary.added, summary.added_after_pruning, summary.delaunay_us, summary.features_us,
              summary.edge_ratio, summary.radius_ratio, summary.edge_gain, summary.radius_gain}) {
          write_spread(out, spread);
        }
        std::vector<double> delaunay;
        for (const GraphResult& graph : results.graphs) {
          if (graph.length == length && graph.nodes == nodes) {
            delaunay.push_back(graph.delaunay.mean_edge_ratio);
          }
        }
        out << ',' << spread_of(std::move(delaunay)).median << '\n';
      }
    }
  }
  return out.str();
}

}  // namespace etcm::compare
