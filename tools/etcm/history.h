// A mesh under events, with the numbers the user gave to nodes and features.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "etcm/dry_run.h"
#include "etcm/files/constraint_graph.h"
#include "etcm/mesh.h"
#include "events.h"

namespace etcm::cli {

class History {
 public:
  // `mesh` is the one of `graph`.
  History(Mesh& mesh, const files::ConstraintGraph& graph);

  // Applies one event. Not ok: the mesh is as it was. unknown_vertex, unknown_feature: the id names
  // nothing.
  Status apply(const Event& event);

  // What it would come to; nothing changes.
  Outcome rehearse(const Event& event);

  // Why the last event was refused, in words that use the numbers of the user.
  std::string explain_refusal(const Event& event, Status status) const;

  // The graph as it is now, in the order of the mesh: node i is that of image_of(), feature i has
  // FeatureId i (free ids leave unused entries).
  files::ConstraintGraph graph() const;

 private:
  bool is_id_taken(const Event& event) const;
  Status apply_to_mesh(const Event& event);
  VertexId vertex(std::int64_t id) const;
  std::string node_name(VertexId vertex) const;
  std::string feature_name(FeatureId feature) const;

  Mesh& mesh_;
  const files::ConstraintGraph& origin_;
  std::map<std::int64_t, VertexId> vertex_of_;
  std::map<std::int64_t, FeatureId> feature_of_;
  bool id_taken_ = false;
};

}  // namespace etcm::cli
