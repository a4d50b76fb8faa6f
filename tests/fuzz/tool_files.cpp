// What the tools read beside graphs: events of a mesh, readings of its nodes, and what simulated
// nodes do. The first byte says which: 'e', 'r' or 's'.
#include <stdexcept>
#include <string>

#include "etcm/audit.h"
#include "etcm/files/error.h"
#include "events.h"
#include "history.h"
#include "inputs/owned_mesh.h"
#include "node_readings.h"
#include "script.h"
#include "text_parts.h"

namespace etcm::fuzz {
namespace {

// Nodes 1 to 5, and the feature 1 from the first to the second.
files::ConstraintGraph graph() {
  files::ConstraintGraph graph;
  for (const Position place : {Position{0, 0}, {100, 0}, {48, 9}, {52, -6}, {50, 80}}) {
    files::GraphNode node;
    node.x = files::Decimal::of(place.x);
    node.y = files::Decimal::of(place.y);
    graph.nodes.push_back(node);
  }
  graph.features.push_back({.from = 0, .to = 1});
  return graph;
}

void replay(const std::string& path) {
  const auto events = cli::read_events(path, {});
  const files::ConstraintGraph origin = graph();
  const files::GridGraph grid = files::place_on_grid(origin, {});
  inputs::OwnedMesh mesh({.vertices_max = 100, .features_max = 20});
  require(mesh->build(grid.nodes, grid.features) == Status::ok, "build()");
  cli::History history(*mesh, origin);
  std::size_t left = 200;
  for (const cli::Event& event : events) {
    if (left-- == 0) break;
    const Outcome outcome = history.rehearse(event);
    const Status status = history.apply(event);
    require(outcome.status == status, "a rehearsal foretold something else");
    if (status != Status::ok) {
      require(!history.explain_refusal(event, status).empty(), "no reason");
    }
  }
  require(audit(*mesh).broken == Rule::none, "the mesh fails its audit");
  require(history.graph().nodes.size() == mesh->node_count(), "nodes are missing");
}

}  // namespace

void run(std::span<const std::uint8_t> bytes) {
  Input input(bytes);
  const std::uint8_t kind = input.byte();
  const std::string path = scratch().write("file", std::string(text_of(input.rest())));
  try {
    if (kind == 'e') return replay(path);
    if (kind == 'r') {
      const files::ConstraintGraph origin = graph();
      const cli::NodeReadings readings = cli::read_node_readings(path, origin);
      require(readings.values.size() == origin.nodes.size(), "readings of no node");
    } else {
      const nodes::Script script = nodes::read_script(path);
      for (const nodes::Event& event : script.events) {
        require(event.node < script.serials.size(), "an event of no node");
      }
    }
  } catch (const std::runtime_error& error) {
    const std::string_view what = error.what();
    require(!what.empty() && what.find('\n') == what.npos, "a mistake is not one line");
  }
}

}  // namespace etcm::fuzz
