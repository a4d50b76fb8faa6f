// etcm nearest IN --at X,Y
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "etcm/nearest.h"
#include "mesher.h"
#include "report.h"

namespace etcm::cli {

namespace {

struct NearestOptions {
  std::string input;
  std::string place;
  std::uint32_t count = 1;
  PlacementOptions placement;
};

double units(const SquaredLength& length) {
  const double square =
      std::ldexp(static_cast<double>(length.high), 64) + static_cast<double>(length.low);
  return std::sqrt(square) / static_cast<double>(subunits_per_unit);
}

// The place itself is not known more exactly.
double rounded(double length) {
  constexpr double digits = 1e8;
  return std::round(length * digits) / digits;
}

int run_nearest(const NearestOptions& options) {
  const files::Placement placement = options.placement.placement();
  const Point place = place_at(options.place, placement);
  const files::ConstraintGraph graph = files::read_graph(options.input);
  files::GridGraph grid = files::place_on_grid(graph, placement);
  // Which nodes are near does not depend on features, so none has to be met.
  grid.features.clear();
  const Meshed meshed = build_mesh(graph, grid, {});
  std::vector<NearNode> found(std::min<std::size_t>(options.count, grid.nodes.size()));
  found.resize(nearest_nodes(**meshed.mesh, place, found));
  const double scale = placement.scale ? placement.scale->to_double() : 1;
  std::string text = "node,distance\n";
  for (const NearNode& near : found) {
    text += std::to_string(graph.node_number(inputs::node_index_of(near.node))) + "," +
            json_number(rounded(units(near.distance) / scale)) + "\n";
  }
  print(text);
  return exit_ok;
}

}  // namespace

void add_nearest_command(CLI::App& program, Run& run) {
  const auto options = std::make_shared<NearestOptions>();
  CLI::App& command =
      *program.add_subcommand("nearest", "The nodes nearest to a place, and how far they are");
  command.add_option("IN", options->input, "Constraint graph: Triangle's .poly, or a .node")
      ->required();
  command.add_option("--at", options->place, "Where, in coordinates of the input")
      ->type_name("X,Y")
      ->required();
  command.add_option("--count", options->count, "How many nodes, as far as there are so many")
      ->check(CLI::Range(std::uint32_t{1}, vertices_max))
      ->capture_default_str();
  options->placement.add_to(command);
  command.callback([options, &run] { run = [options] { return run_nearest(*options); }; });
}

}  // namespace etcm::cli
