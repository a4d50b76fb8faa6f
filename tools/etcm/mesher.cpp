#include "mesher.h"

#include <array>

#include "etcm/files/decimal.h"
#include "etcm/files/error.h"

namespace etcm::cli {

namespace {

bool is_shortfall(Status status) {
  return status == Status::out_of_vertices || status == Status::steiner_budget ||
         status == Status::grid_exhausted;
}

std::uint32_t at_most(std::size_t value, std::uint32_t limit) {
  return static_cast<std::uint32_t>(std::min<std::size_t>(value, limit));
}

std::unique_ptr<inputs::OwnedMesh> open_mesh(const MeshConfig& config) {
  auto mesh = std::make_unique<inputs::OwnedMesh>(config);
  if (mesh->opened() != Status::ok) {
    throw files::InputError(std::string("no mesh of this size: ") + explain(mesh->opened()));
  }
  return mesh;
}

using Clock = std::chrono::steady_clock;

double microseconds_between(Clock::time_point start, Clock::time_point end) {
  return std::chrono::duration<double, std::micro>(end - start).count();
}

void note_time(void* moment) noexcept { *static_cast<Clock::time_point*>(moment) = Clock::now(); }

// Builds, and looks at the clock when the nodes stand and at the end.
void build_timed(Meshed& meshed, const files::GridGraph& grid) {
  const Clock::time_point start = Clock::now();
  Clock::time_point nodes_stand = start;
  meshed.status =
      (*meshed.mesh)->build(grid.nodes, grid.features, Work::unlimited(), note_time, &nodes_stand);
  meshed.delaunay_us = microseconds_between(start, nodes_stand);
  meshed.conform_us = microseconds_between(nodes_stand, Clock::now());
}

// Trials for each Steiner vertex of the mesh, by effort. The last takes some 10 s on 1000 nodes
// with 150 long features.
constexpr std::array<std::uint32_t, effort_most + 1> trials_each{0,  1,  2,   5,   10,
                                                                 25, 60, 150, 300, 700};
// A trial may have so many Steiner vertices more than the mesh.
constexpr std::uint32_t optimise_room = 20;

void optimise(Meshed& meshed, unsigned effort) {
  const Clock::time_point start = Clock::now();
  Mesh& mesh = **meshed.mesh;
  const std::uint64_t trials = std::uint64_t{mesh.steiner_count()} * trials_each.at(effort);
  static_cast<void>(
      mesh.optimise(static_cast<std::uint32_t>(std::min<std::uint64_t>(trials, 0xffffffffu))));
  meshed.optimise_us = microseconds_since(start);
}

bool has_room_to_optimise(const Mesh& mesh) {
  return mesh.node_count() + mesh.steiner_count() + optimise_room <= mesh.config().vertices_max;
}

}  // namespace

double microseconds_since(Clock::time_point start) {
  return microseconds_between(start, Clock::now());
}

Meshed build_mesh(const files::ConstraintGraph& graph, const files::GridGraph& grid,
                  const MeshingPlan& plan) {
  const std::size_t nodes = grid.nodes.size() + plan.spare_vertices;
  const std::size_t features = grid.features.size() + plan.spare_features;
  MeshConfig config;
  config.policy = plan.policy;
  config.steiner_max = plan.steiner_max;
  config.vertices_max = at_most(2 * nodes + 8 * features + 64, vertices_max);
  // Features do not cross, so a node divides at most one of them in two.
  config.features_max = at_most(features + nodes, features_limit);

  Meshed meshed;
  while (true) {
    meshed.mesh = open_mesh(config);
    build_timed(meshed, grid);
    const bool has_room = plan.effort == 0 || has_room_to_optimise(**meshed.mesh);
    if (meshed.status == Status::ok && has_room) break;
    if (meshed.status != Status::ok && meshed.status != Status::out_of_vertices) break;
    if (config.vertices_max == vertices_max) break;
    config.vertices_max = at_most(std::size_t{config.vertices_max} * 2, vertices_max);
  }
  if (meshed.status != Status::ok && !is_shortfall(meshed.status)) {
    throw files::InputError(describe_refusal(graph, grid, (*meshed.mesh)->error_detail()));
  }
  if (meshed.status != Status::ok && (*meshed.mesh)->node_count() != grid.nodes.size()) {
    throw files::InputError(graph.node_file, 0,
                            std::to_string(grid.nodes.size()) +
                                " nodes; this build meshes at most " +
                                std::to_string(vertices_max));
  }
  if (meshed.status == Status::ok && plan.effort != 0) optimise(meshed, plan.effort);
  return meshed;
}

std::string describe_shortfall(const files::ConstraintGraph& graph, const ErrorDetail& error_detail,
                               std::uint32_t unresolved) {
  std::string text = std::to_string(unresolved) +
                     (unresolved == 1 ? " subsegment is no edge" : " subsegments are no edges");
  if (!error_detail.feature.is_none() && error_detail.feature.value < graph.features.size()) {
    const std::size_t feature = error_detail.feature.value;
    text += ", first of " + files::feature_name(graph, feature) + " on line " +
            std::to_string(graph.features[feature].line_number) + ", from " +
            files::coordinate_text(error_detail.from.x) + " " +
            files::coordinate_text(error_detail.from.y) + " to " +
            files::coordinate_text(error_detail.to.x) + " " +
            files::coordinate_text(error_detail.to.y);
  }
  return text + ": " + explain(error_detail.status);
}

}  // namespace etcm::cli
