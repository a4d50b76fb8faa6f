// etcm mesh IN.poly -o OUT
#include <iostream>
#include <memory>

#include "command.h"
#include "lower_bound.h"
#include "mesher.h"
#include "output.h"
#include "report.h"

namespace etcm::cli {

namespace {

struct MeshOptions {
  std::string input;
  OutputOptions output;
  PlacementOptions placement;
  std::string policy = "default";
  std::uint32_t steiner_max = 0;
  unsigned effort = 0;
  bool json = false;
};

int run_mesh(const MeshOptions& options) {
  const files::Placement placement = options.placement.placement();
  const files::ConstraintGraph graph = files::read_graph(options.input);
  options.output.refuse_overwriting(graph);
  const files::GridGraph grid = files::place_on_grid(graph, placement);
  const MeshingPlan plan{.policy = policy_named(options.policy),
                         .steiner_max = options.steiner_max,
                         .effort = options.effort};
  const Meshed meshed = build_mesh(graph, grid, plan);
  files::MeshImage image = files::image_of(**meshed.mesh, options.output.exterior(), grid.holes);
  files::carry_through(graph, placement, image);
  options.output.write(**meshed.mesh, image);
  const std::uint64_t least = least_steiner_of(grid);
  if (options.json) {
    print(json_object(describe_mesh(meshed, image, least, options.policy)));
  } else {
    print(options.output.base() + ": " + summary(meshed, image, least));
  }
  if (meshed.status == Status::ok) return exit_ok;
  const Mesh& mesh = **meshed.mesh;
  std::cerr << "etcm: " << options.input << ": "
            << describe_shortfall(graph, mesh.error_detail(), mesh.unresolved()) << std::endl;
  return exit_unresolved;
}

}  // namespace

void add_mesh_command(CLI::App& program, Run& run) {
  const auto options = std::make_shared<MeshOptions>();
  CLI::App& command = *program.add_subcommand("mesh", "Mesh a constraint graph");
  command.add_option("IN", options->input, "Constraint graph: Triangle's .poly, or a .node")
      ->required();
  options->output.add_to(command);
  options->placement.add_to(command);
  add_policy_option(command, options->policy);
  command.add_option("--steiner-max", options->steiner_max,
                     "Most Steiner vertices to add; 0 for as many as it takes");
  command
      .add_option(
          "--effort", options->effort,
          "Look for fewer Steiner vertices: 0 not at all, 1 as long as the mesh takes, up to "
          "9 for some 10 s on 1000 nodes")
      ->check(CLI::Range(0u, effort_most))
      ->capture_default_str();
  command.add_flag("--json", options->json, "Print one JSON object instead of a sentence");
  command.callback([options, &run] { run = [options] { return run_mesh(*options); }; });
}

}  // namespace etcm::cli
