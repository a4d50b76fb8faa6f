#include "compare/rival.h"

#include <span>

#include "compare/stopwatch.h"
#include "inputs/owned_mesh.h"

namespace etcm::compare {
namespace {

using namespace internal;

Status insert_features(MeshState& m, std::span<const FeatureEnds> features, const RivalRule& rule) {
  begin(m);
  // All roots first, so that feature i has the id i.
  for (const FeatureEnds& ends : features) {
    const SectionId root = allocate_section(m);
    if (root.is_none()) return Status::out_of_features;
    set_ends(m, root, ends.from, ends.to);
    ++m.feature_count;
  }
  for (std::size_t i = 0; i < features.size(); ++i) {
    const SectionId root{static_cast<IdValue>(i)};
    const Course course = survey(m, root);
    if (course.status != Status::ok) return course.status;
    lay(m, root, course.nodes_between);
    const Status status = rule.conform(m);
    if (status != Status::ok) return status;
  }
  return rule.finish == nullptr ? Status::ok : rule.finish(m);
}

}  // namespace

Attempt run_rival(const inputs::Graph& graph, const RivalRule& rule, Depth depth) {
  inputs::OwnedMesh mesh(inputs::config_for(graph, steiner_room(graph), rule.policy));
  Attempt attempt;
  Stopwatch watch;
  Status status = mesh->build(graph.nodes, {});
  attempt.delaunay_us = watch.lap_us();
  MeshState& m = state_of(*mesh);
  if (status == Status::ok) status = insert_features(m, graph.features, rule);
  attempt.total_us = attempt.delaunay_us + watch.lap_us();
  attempt.added = mesh->steiner_count();
  if (status != Status::ok) {
    attempt.verdict = Verdict::out_of_room;
    return attempt;
  }
  if (depth == Depth::times) return attempt;
  attempt.verdict = verdict_of(*mesh);
  attempt.hash = mesh->hash();
  attempt.image = files::image_of(*mesh, Exterior::hull, {});
  commit(m);
  attempt.added_after_pruning = mesh->steiner_count();
  return attempt;
}

Status insert_on_section(MeshState& m, SectionId section, Parameter parameter, Edge near) noexcept {
  const VertexId v = allocate_vertex(m);
  if (v.is_none()) return Status::out_of_vertices;
  m.points[v.value] = point_at(m, section, parameter);
  m.owner(v) = Owner(Role::fresh, section);
  ++m.steiner_count;
  insert_vertex(m, v, find(m, m.at(v), near));
  return Status::ok;
}

PieceEnds ends_of_piece(const MeshState& m, SectionId section, VertexId head,
                        VertexId tail) noexcept {
  return {head == m.section(section).from ? 0 : parameter_of(m, section, head),
          tail == m.section(section).to ? parameter_end : parameter_of(m, section, tail)};
}

Parameter split_middle(const SplitSite& site) noexcept {
  return static_cast<Parameter>(site.head + (site.tail - site.head) / 2);
}

}  // namespace etcm::compare
