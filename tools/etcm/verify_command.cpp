// etcm verify IN.poly OUT
#include <iostream>
#include <memory>

#include "command.h"
#include "conformity.h"
#include "etcm/files/mesh_text.h"
#include "lower_bound.h"

namespace etcm::cli {

namespace {

struct VerifyOptions {
  std::string input;
  std::string base;
  PlacementOptions placement;
  bool bound = false;
};

int run_verify(const VerifyOptions& options) {
  const files::Placement placement = options.placement.placement();
  const files::ConstraintGraph graph = files::read_graph(options.input);
  const files::GridGraph grid = files::place_on_grid(graph, placement);
  const files::MeshImage image = files::read_mesh(options.base);
  if (const auto violation = first_violation({graph, grid, image})) {
    std::cerr << "etcm: " << options.base << ": " << *violation << std::endl;
    return exit_not_a_mesh;
  }
  const std::size_t steiner = image.vertices.size() - grid.nodes.size();
  const std::string bound =
      options.bound ? " (" + describe_bound(least_steiner_of(grid), steiner) + ")" : "";
  print(options.base + ": exactly conforming and Delaunay: " + std::to_string(grid.nodes.size()) +
        " nodes, " + std::to_string(grid.features.size()) + " features, " +
        std::to_string(steiner) + " Steiner vertices" + bound + ", " +
        std::to_string(image.triangles.size()) + " triangles\n");
  return exit_ok;
}

}  // namespace

void add_verify_command(CLI::App& program, Run& run) {
  const auto options = std::make_shared<VerifyOptions>();
  CLI::App& command =
      *program.add_subcommand("verify", "Check a written mesh against its input, exactly");
  command.add_option("IN", options->input, "Constraint graph: Triangle's .poly, or a .node")
      ->required();
  command.add_option("OUT", options->base, "The mesh, as -o of mesh named it")->required();
  options->placement.add_to(command);
  command.add_flag(
      "--bound", options->bound,
      "Work out from the input, too, how few Steiner vertices any mesh of it can have");
  command.callback([options, &run] { run = [options] { return run_verify(*options); }; });
}

}  // namespace etcm::cli
