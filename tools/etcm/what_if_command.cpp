// etcm what-if IN.poly EVENTS
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "command.h"
#include "etcm/dry_run.h"
#include "etcm/files/error.h"
#include "events.h"
#include "history.h"
#include "mesher.h"

namespace etcm::cli {

namespace {

struct WhatIfOptions {
  std::string input;
  std::string events;
  PlacementOptions placement;
  std::string policy = "default";
};

// One row for each event. None: the mesh has no room for one of them.
std::optional<std::string> table_of(History& history, const std::vector<Event>& events) {
  std::string text = "event,id,answer,steiner\n";
  for (const Event& event : events) {
    const etcm::Outcome outcome = history.rehearse(event);
    if (outcome.status == Status::out_of_vertices || outcome.status == Status::out_of_features) {
      return std::nullopt;
    }
    text += std::string(name_of(event.kind)) + "," + std::to_string(event.id) + "," +
            to_string(outcome.status) + ",";
    if (outcome.status == Status::ok) text += std::to_string(outcome.steiner);
    text += "\n";
  }
  return text;
}

int run_what_if(const WhatIfOptions& options) {
  const files::Placement placement = options.placement.placement();
  const files::ConstraintGraph graph = files::read_graph(options.input);
  const files::GridGraph grid = files::place_on_grid(graph, placement);
  const std::vector<Event> events = read_events(options.events, placement);
  MeshingPlan plan{
      .policy = policy_named(options.policy), .spare_vertices = 64, .spare_features = 64};
  while (true) {
    const Meshed meshed = build_mesh(graph, grid, plan);
    Mesh& mesh = **meshed.mesh;
    if (meshed.status != Status::ok) {
      std::cerr << "etcm: " << options.input << ": no event was looked at: "
                << describe_shortfall(graph, mesh.error_detail(), mesh.unresolved()) << std::endl;
      return exit_unresolved;
    }
    History history(mesh, graph);
    if (const auto table = table_of(history, events)) {
      print(*table);
      return exit_ok;
    }
    if (plan.spare_vertices >= vertices_max) {
      throw files::InputError(options.events, 0,
                              "the mesh outgrows " + std::to_string(vertices_max) + " vertices");
    }
    plan.spare_vertices = 2 * plan.spare_vertices + grid.nodes.size();
  }
}

}  // namespace

void add_what_if_command(CLI::App& program, Run& run) {
  const auto options = std::make_shared<WhatIfOptions>();
  CLI::App& command = *program.add_subcommand(
      "what-if", "What each of some events would come to, if it were the only one");
  command.add_option("IN", options->input, "Constraint graph: Triangle's .poly, or a .node")
      ->required();
  command.add_option("EVENTS", options->events, "One event a line, as those of replay")->required();
  options->placement.add_to(command);
  add_policy_option(command, options->policy);
  command.callback([options, &run] { run = [options] { return run_what_if(*options); }; });
}

}  // namespace etcm::cli
