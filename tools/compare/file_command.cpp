// etcm-compare FILE.poly: the five criteria on a graph of the user's.
#include <algorithm>
#include <iostream>
#include <memory>

#include "command.h"  // of tools/etcm: --scale and --round
#include "compare/commands.h"
#include "compare/measurement.h"
#include "compare/progress.h"
#include "compare/report/tables.h"
#include "etcm/files/error.h"
#include "inputs/owned_mesh.h"

namespace etcm::compare {
namespace {

struct FileOptions {
  std::string input;
  std::vector<std::string> systems;
  double limit_s = 60;
  cli::PlacementOptions placement;
};

// Refused once, in the words of the mesher, not by each system in its own.
inputs::Graph read_legal_graph(const FileOptions& options) {
  const files::ConstraintGraph file = files::read_graph(options.input);
  files::GridGraph grid = files::place_on_grid(file, options.placement.placement());
  inputs::Graph graph{options.input, std::move(grid.nodes), std::move(grid.features)};
  inputs::OwnedMesh mesh(inputs::config_for(graph, 0));
  const Status status = mesh->build(graph.nodes, graph.features);
  if (status != Status::ok && status != Status::out_of_vertices) {
    grid.nodes = graph.nodes;
    grid.features = graph.features;
    throw files::InputError(files::describe_refusal(file, grid, mesh->error_detail()));
  }
  return graph;
}

int compare_file(const FileOptions& options) {
  const std::vector<System> systems = systems_named(options.systems);
  const inputs::Graph graph = read_legal_graph(options);
  std::vector<Measurement> measured;
  {
    Progress progress;
    for (const System& system : systems) {
      progress.show(static_cast<double>(measured.size()) / static_cast<double>(systems.size()),
                    std::string(system.label));
      measured.push_back(
          measure(system, graph, std::chrono::milliseconds(std::llround(options.limit_s * 1000))));
    }
  }
  std::cout << graph.nodes.size() << " nodes, " << graph.features.size() << " features\n\n"
            << graph_table(systems, measured);
  return std::all_of(measured.begin(), measured.end(),
                     [](const Measurement& m) { return m.verdict == Verdict::ok; })
             ? 0
             : 1;
}

}  // namespace

void add_file_command(CLI::App& program, Run& run) {
  const auto options = std::make_shared<FileOptions>();
  program.add_option("FILE", options->input, "Compare on this graph: Triangle's .poly, or a .node");
  program.add_option("--systems", options->systems, "These instead of the eight: " + known_keys())
      ->delimiter(',');
  program.add_option("--limit", options->limit_s, "Seconds that each system may spend")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  options->placement.add_to(program);
  program.callback([options, &run, &program] {
    if (program.get_subcommands().empty() && !options->input.empty()) {
      run = [options] { return compare_file(*options); };
    }
  });
}

}  // namespace etcm::compare
