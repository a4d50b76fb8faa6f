#include "history.h"

#include <algorithm>

namespace etcm::cli {

History::History(Mesh& mesh, const files::ConstraintGraph& graph) : mesh_(mesh), origin_(graph) {
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    vertex_of_[graph.node_number(i)] = VertexId(static_cast<IdValue>(i + 1));
  }
  for (std::size_t i = 0; i < graph.features.size(); ++i) {
    feature_of_[graph.feature_number(i)] = FeatureId(static_cast<IdValue>(i));
  }
}

VertexId History::vertex(std::int64_t id) const {
  const auto found = vertex_of_.find(id);
  return found == vertex_of_.end() ? VertexId::none() : found->second;
}

bool History::is_id_taken(const Event& event) const {
  return (event.kind == EventKind::join && vertex_of_.contains(event.id)) ||
         (event.kind == EventKind::feature && feature_of_.contains(event.id));
}

namespace {

Status refusal_of_taken_id(const Event& event) {
  return event.kind == EventKind::join ? Status::duplicate_vertex : Status::repeated_feature;
}

}  // namespace

Status History::apply(const Event& event) {
  id_taken_ = is_id_taken(event);
  return id_taken_ ? refusal_of_taken_id(event) : apply_to_mesh(event);
}

// The mesh refuses ids of none by the same words.
Outcome History::rehearse(const Event& event) {
  if (is_id_taken(event)) return {.status = refusal_of_taken_id(event)};
  DryRun dry(mesh_);
  switch (event.kind) {
    case EventKind::join:
      return dry.join(event.position);
    case EventKind::leave:
      return dry.leave(vertex(event.id));
    case EventKind::move:
      return dry.move(vertex(event.id), event.position);
    case EventKind::feature:
      return dry.add_feature({vertex(event.from), vertex(event.to)});
    case EventKind::unfeature: {
      const auto feature = feature_of_.find(event.id);
      return dry.remove_feature(feature == feature_of_.end() ? FeatureId::none() : feature->second);
    }
  }
  return {};
}

Status History::apply_to_mesh(const Event& event) {
  const VertexId node = vertex(event.id);
  switch (event.kind) {
    case EventKind::join: {
      VertexId id;
      const Status status = mesh_.join(event.position, id);
      if (status == Status::ok) vertex_of_[event.id] = id;
      return status;
    }
    case EventKind::leave: {
      if (node.is_none()) return Status::unknown_vertex;
      const Status status = mesh_.leave(node);
      if (status == Status::ok) vertex_of_.erase(event.id);
      return status;
    }
    case EventKind::move:
      return node.is_none() ? Status::unknown_vertex : mesh_.move(node, event.position);
    case EventKind::feature: {
      const FeatureEnds ends{vertex(event.from), vertex(event.to)};
      if (ends.from.is_none() || ends.to.is_none()) return Status::unknown_vertex;
      FeatureId id;
      const Status status = mesh_.add_feature(ends, id);
      if (status == Status::ok) feature_of_[event.id] = id;
      return status;
    }
    case EventKind::unfeature: {
      const auto feature = feature_of_.find(event.id);
      if (feature == feature_of_.end()) return Status::unknown_feature;
      const Status status = mesh_.remove_feature(feature->second);
      if (status == Status::ok) feature_of_.erase(feature);
      return status;
    }
  }
  return Status::ok;
}

std::string History::node_name(VertexId vertex) const {
  for (const auto& [id, known] : vertex_of_) {
    if (known == vertex) return "node " + std::to_string(id);
  }
  return "";
}

std::string History::feature_name(FeatureId feature) const {
  for (const auto& [id, known] : feature_of_) {
    if (known == feature) return "feature " + std::to_string(id);
  }
  return "";
}

std::string History::explain_refusal(const Event& event, Status status) const {
  if (id_taken_) return "id " + std::to_string(event.id) + " is taken; use another";
  if (status == Status::unknown_vertex && event.kind == EventKind::feature) {
    const bool first = vertex(event.from).is_none();
    return "node " + std::to_string(first ? event.from : event.to) + " does not exist";
  }
  if (status == Status::unknown_vertex || status == Status::unknown_feature) {
    return "id " + std::to_string(event.id) + " does not exist";
  }
  std::string in_the_way;
  const ErrorDetail& error_detail = mesh_.error_detail();
  if (!error_detail.vertex.is_none()) in_the_way = node_name(error_detail.vertex);
  if (in_the_way.empty() && !error_detail.other.is_none())
    in_the_way = feature_name(error_detail.other);
  return explain(status) + (in_the_way.empty() ? "" : " (in the way: " + in_the_way + ")");
}

files::ConstraintGraph History::graph() const {
  files::ConstraintGraph now = origin_;
  now.nodes.clear();
  now.attributes.clear();
  now.features.assign(mesh_.feature_id_end(), {});
  std::vector<std::pair<VertexId, std::int64_t>> order;
  for (const auto& [id, vertex] : vertex_of_) order.emplace_back(vertex, id);
  std::sort(order.begin(), order.end());
  const auto origin_index = [&](std::int64_t number, int base, std::size_t count) {
    const std::int64_t index = number - base;
    return index >= 0 && index < static_cast<std::int64_t>(count) ? static_cast<std::size_t>(index)
                                                                  : count;
  };
  std::vector<std::uint32_t> place_of(mesh_.vertex_id_end(), 0);
  for (const auto& [vertex, id] : order) {
    const Position position = mesh_.position(vertex);
    place_of[vertex.value] = static_cast<std::uint32_t>(now.nodes.size());
    const std::size_t index = origin_index(id, origin_.index_base, origin_.nodes.size());
    const bool is_original = index < origin_.nodes.size();
    now.nodes.push_back({files::Decimal::of(position.x), files::Decimal::of(position.y),
                         is_original ? origin_.nodes[index].marker : 0, 0});
    for (std::size_t a = 0; a < origin_.attribute_count; ++a) {
      now.attributes.push_back(is_original ? origin_.attributes[index * origin_.attribute_count + a]
                                           : "0");
    }
  }
  for (const auto& [id, feature] : feature_of_) {
    const FeatureEnds ends = mesh_.ends(feature);
    const std::size_t index = origin_index(id, origin_.feature_base, origin_.features.size());
    now.features[feature.value] = {
        place_of[ends.from.value], place_of[ends.to.value],
        index < origin_.features.size() ? origin_.features[index].marker : 0, 0};
  }
  return now;
}

}  // namespace etcm::cli
