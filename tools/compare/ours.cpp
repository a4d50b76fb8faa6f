// This library as its users get it: Mesh::build() with the default policy.
#include "compare/stopwatch.h"
#include "compare/system.h"
#include "inputs/owned_mesh.h"

namespace etcm::compare {

Attempt run_default(const inputs::Graph& graph, Depth depth) {
  inputs::OwnedMesh mesh(inputs::config_for(graph, steiner_room(graph)));
  Attempt attempt;
  Stopwatch watch;
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

}  // namespace etcm::compare
