// This library as its users get it, Mesh::build(): with the default policy it is "ours", with the
// policy `paper` it is the paper's split rule inside our build.
#include "compare/systems/stopwatch.h"
#include "compare/systems/system.h"
#include "inputs/owned_mesh.h"

namespace etcm::compare {
namespace {

Attempt run_build(const inputs::Graph& graph, SplitPolicy policy, Depth depth) {
  inputs::OwnedMesh mesh(inputs::config_for(graph, steiner_room(graph), policy));
  Attempt attempt;
  CpuStopwatch watch;
  Status status = mesh->build(graph.nodes, {});
  attempt.delaunay_us = watch.lap_us();
  mesh->clear();
  watch.lap_us();
  status = mesh->build(graph.nodes, graph.features);
  attempt.total_us = watch.lap_us();
  attempt.added = attempt.added_after_pruning = mesh->steiner_count();
  if (status != Status::ok) {
    attempt.verdict = Verdict::out_of_room;
    return attempt;
  }
  if (depth == Depth::times) return attempt;
  attempt.verdict = verdict_of(*mesh);
  attempt.hash = mesh->hash();
  attempt.image = files::image_of(*mesh, Exterior::hull, {});
  return attempt;
}

}  // namespace

Attempt run_default(const inputs::Graph& graph, Depth depth) {
  return run_build(graph, split_default, depth);
}

Attempt run_paper_policy(const inputs::Graph& graph, Depth depth) {
  return run_build(graph, split_paper, depth);
}

}  // namespace etcm::compare
