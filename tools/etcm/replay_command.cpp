// etcm replay IN.poly EVENTS -o OUT
#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <memory>

#include "command.h"
#include "etcm/files/error.h"
#include "events.h"
#include "history.h"
#include "lower_bound.h"
#include "mesher.h"
#include "output.h"
#include "report.h"

namespace etcm::cli {

namespace {

struct ReplayOptions {
  std::string input;
  std::string events;
  OutputOptions output;
  PlacementOptions placement;
  std::string policy = "default";
  bool keep_going = false;
  bool json = false;
};

struct Replayed {
  Meshed meshed;
  files::ConstraintGraph graph;  // as it is after the events
  std::vector<double> latency_us;
  double canonicalize_us = 0;
  std::size_t refused = 0;
  bool needs_room = false;
};

std::size_t count_kind(const std::vector<Event>& events, EventKind kind) {
  return static_cast<std::size_t>(
      std::count_if(events.begin(), events.end(), [&](const Event& e) { return e.kind == kind; }));
}

Replayed replay(const ReplayOptions& options, const files::ConstraintGraph& graph,
                const files::GridGraph& grid, const std::vector<Event>& events,
                const MeshingPlan& plan) {
  Replayed result;
  result.meshed = build_mesh(graph, grid, plan);
  result.graph = graph;
  if (result.meshed.status != Status::ok) return result;
  Mesh& mesh = **result.meshed.mesh;
  History history(mesh, graph);
  for (const Event& event : events) {
    const auto start = std::chrono::steady_clock::now();
    const Status status = history.apply(event);
    result.latency_us.push_back(microseconds_since(start));
    if (status == Status::ok) continue;
    if (status == Status::out_of_vertices || status == Status::out_of_features) {
      result.needs_room = true;
      return result;
    }
    if (!options.keep_going) {
      throw files::InputError(
          options.events, event.line_number,
          history.explain_refusal(event, status) + " (--keep-going skips such events)");
    }
    ++result.refused;
  }
  // Then it is the mesh that `etcm mesh` makes of the graph as it is now.
  const auto start = std::chrono::steady_clock::now();
  const Status status = mesh.canonicalize();
  result.canonicalize_us = microseconds_since(start);
  result.needs_room = status == Status::out_of_vertices;
  result.graph = history.graph();
  return result;
}

double percentile(const std::vector<double>& sorted, double part) {
  if (sorted.empty()) return 0;
  const auto last = static_cast<double>(sorted.size() - 1);
  return sorted[static_cast<std::size_t>(std::lround(part * last))];
}

Members describe_events(Replayed& replayed) {
  auto& latency = replayed.latency_us;
  std::sort(latency.begin(), latency.end());
  return {{"events", std::to_string(latency.size())},
          {"refused", std::to_string(replayed.refused)},
          {"event_p50_us", json_number(percentile(latency, 0.50))},
          {"event_p90_us", json_number(percentile(latency, 0.90))},
          {"event_p99_us", json_number(percentile(latency, 0.99))},
          {"event_max_us", json_number(percentile(latency, 1))},
          {"canonicalize_us", json_number(replayed.canonicalize_us)}};
}

int run_replay(const ReplayOptions& options) {
  const files::Placement placement = options.placement.placement();
  const files::ConstraintGraph graph = files::read_graph(options.input);
  options.output.refuse_overwriting(graph);
  const files::GridGraph grid = files::place_on_grid(graph, placement);
  const std::vector<Event> events = read_events(options.events, placement);
  MeshingPlan plan{.policy = policy_named(options.policy),
                   .spare_vertices = count_kind(events, EventKind::join),
                   .spare_features = count_kind(events, EventKind::feature)};
  Replayed replayed = replay(options, graph, grid, events, plan);
  while (replayed.needs_room && plan.spare_vertices < vertices_max) {
    plan.spare_vertices = 2 * plan.spare_vertices + grid.nodes.size() + 64;
    replayed = replay(options, graph, grid, events, plan);
  }
  if (replayed.needs_room) {
    throw files::InputError(options.events, 0,
                            "the mesh outgrows " + std::to_string(vertices_max) + " vertices");
  }
  const Mesh& mesh = **replayed.meshed.mesh;
  files::MeshImage image = files::image_of(mesh, options.output.exterior(), grid.holes);
  files::carry_through(replayed.graph, placement, image);
  options.output.write(mesh, image);
  const std::uint64_t least = least_steiner_of(mesh);
  Members members = describe_mesh(replayed.meshed, image, least, options.policy);
  const Members about_events = describe_events(replayed);
  if (options.json) {
    members.insert(members.end(), about_events.begin(), about_events.end());
    print(json_object(members));
  } else {
    std::string text = options.output.base() + ": " + summary(replayed.meshed, image, least);
    for (const auto& [name, value] : about_events) text += name + " " + value + "\n";
    print(text);
  }
  if (replayed.meshed.status == Status::ok) return exit_ok;
  std::cerr << "etcm: " << options.input << ": no event was applied: "
            << describe_shortfall(graph, mesh.error_detail(), mesh.unresolved()) << std::endl;
  return exit_unresolved;
}

}  // namespace

void add_replay_command(CLI::App& program, Run& run) {
  const auto options = std::make_shared<ReplayOptions>();
  CLI::App& command = *program.add_subcommand("replay",
                                              "Mesh a graph, then let nodes and features "
                                              "come and go");
  command.add_option("IN", options->input, "Constraint graph: Triangle's .poly, or a .node")
      ->required();
  command
      .add_option("EVENTS", options->events,
                  "One event a line: join ID X Y, leave ID, move ID X Y, feature ID A B, "
                  "unfeature ID")
      ->required();
  options->output.add_to(command);
  options->placement.add_to(command);
  add_policy_option(command, options->policy);
  command.add_flag("--keep-going", options->keep_going, "Count refused events and go on");
  command.add_flag("--json", options->json, "Print one JSON object instead of sentences");
  command.callback([options, &run] { run = [options] { return run_replay(*options); }; });
}

}  // namespace etcm::cli
