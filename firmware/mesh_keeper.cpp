#include "mesh_keeper.h"

#include <algorithm>

namespace etcm::firmware {

namespace {

std::string place_text(Position position) {
  return "(" + std::to_string(position.x) + ", " + std::to_string(position.y) + ")";
}

std::string counted(std::uint32_t count, const std::string& one, const std::string& many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

bool is_room_status(Status status) {
  switch (status) {
    case Status::out_of_vertices:
    case Status::out_of_features:
    case Status::steiner_budget:
    case Status::step_limit:
    case Status::grid_exhausted:
      return true;
    default:
      return false;
  }
}

}  // namespace

MeshKeeper::MeshKeeper(Mesh& mesh, std::span<const FeatureSettings> features, Roster& roster,
                       const port::Clock& clock, port::Log& log)
    : mesh_(mesh),
      roster_(roster),
      clock_(clock),
      log_(log),
      features_(features, mesh.config().features_max),
      serials_(mesh.config().vertices_max + 1, no_serial) {}

void MeshKeeper::join(NodeRecord& node, std::uint32_t generation) {
  if (!is_worth_a_try(node)) return;
  const Before start = before();
  VertexId id;
  const Status status = mesh_.join(node.position, id);
  if (status != Status::ok) return refuse(node, "join", status);
  changed_ = true;
  node.vertex = id;
  node.placed = node.position;
  node.refusal = Status::ok;
  serials_[id.value] = node.serial;
  activate_features_of(node);
  log_.write(port::Level::info,
             "node " + std::to_string(node.serial) + " joined at " + place_text(node.placed) +
                 ": generation " + std::to_string(generation) + ", " +
                 counted(mesh_.neighbours(id, {}), "neighbour", "neighbours") + difference(start));
}

void MeshKeeper::move(NodeRecord& node, std::uint32_t generation) {
  if (!is_worth_a_try(node)) return;
  const Before start = before();
  const Status status = mesh_.move(node.vertex, node.position);
  if (status != Status::ok) return refuse(node, "move", status);
  changed_ = true;
  const Position from = node.placed;
  node.placed = node.position;
  node.refusal = Status::ok;
  ++epoch_;
  log_.write(port::Level::info, "node " + std::to_string(node.serial) + " moved from " +
                                    place_text(from) + " to " + place_text(node.placed) +
                                    ": generation " + std::to_string(generation) +
                                    difference(start));
}

void MeshKeeper::leave(NodeRecord& node, const char* why, std::uint32_t generation) {
  const Before start = before();
  for (const std::uint32_t number : features_.ending_at(node.serial)) {
    const FeatureRecord& feature = features_.records()[number];
    // An active feature is one the mesh has, so nothing can be wrong with its id.
    if (feature.is_active()) static_cast<void>(mesh_.remove_feature(feature.id));
    features_.deactivate(number);
  }
  const bool lost_features = features_.active_count() != start.features_active;
  if (node.refusal != Status::ok && node.refused_epoch == epoch_ && !lost_features) return;
  const Status status = mesh_.leave(node.vertex);
  ++epoch_;
  changed_ = true;
  if (status != Status::ok) return refuse(node, "leave", status);
  serials_[node.vertex.value] = no_serial;
  node.vertex = VertexId::none();
  node.refusal = Status::ok;
  log_.write(port::Level::info, "node " + std::to_string(node.serial) + " left (" + why +
                                    "): generation " + std::to_string(generation) +
                                    difference(start));
}

void MeshKeeper::forgive(NodeRecord& node) {
  if (node.refusal == Status::ok) return;
  node.refusal = Status::ok;
  changed_ = true;
}

void MeshKeeper::retry_refused(std::uint32_t generation) {
  if (retried_epoch_ == epoch_) return;
  retried_epoch_ = epoch_;
  for (NodeRecord& node : roster_.records()) {
    if (node.is_known() && !node.is_placed() && node.refusal != Status::ok) join(node, generation);
  }
  if (features_.refused_count() == 0) return;
  for (std::uint32_t number = 0; number < features_.records().size(); ++number) {
    if (features_.records()[number].refusal != Status::ok) try_feature(number);
  }
}

bool MeshKeeper::is_short_of_room() const {
  return std::any_of(roster_.records().begin(), roster_.records().end(),
                     [](const NodeRecord& node) { return is_room_status(node.refusal); }) ||
         std::any_of(features_.records().begin(), features_.records().end(),
                     [](const FeatureRecord& feature) { return is_room_status(feature.refusal); });
}

MeshKeeper::Before MeshKeeper::before() const {
  return {.at = clock_.now(),
          .steiner_count = mesh_.steiner_count(),
          .features_active = features_.active_count()};
}

std::string MeshKeeper::difference(const Before& start) const {
  const std::uint32_t steiner = mesh_.steiner_count();
  const std::uint32_t active = features_.active_count();
  std::string text;
  if (steiner < start.steiner_count) {
    text += ", " + counted(start.steiner_count - steiner, "Steiner vertex", "Steiner vertices") +
            " taken out";
  } else {
    text += ", " + counted(steiner - start.steiner_count, "Steiner vertex", "Steiner vertices") +
            " added";
  }
  if (active > start.features_active) {
    text += ", " + counted(active - start.features_active, "feature", "features") + " active";
  } else if (active < start.features_active) {
    text += ", " + counted(start.features_active - active, "feature", "features") + " waiting";
  }
  const std::int64_t tenths = (clock_.now() - start.at) / std::chrono::nanoseconds(100);
  return text + ", " + std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " us";
}

// The mesh would only say the same again.
bool MeshKeeper::is_worth_a_try(const NodeRecord& node) const {
  return node.refusal == Status::ok || node.refused_at != node.position ||
         node.refused_epoch != epoch_;
}

void MeshKeeper::refuse(NodeRecord& node, const char* verb, Status status) {
  const bool is_news = node.refusal != status || node.refused_at != node.position;
  node.refusal = status;
  node.refused_at = node.position;
  node.refused_epoch = epoch_;
  if (is_news) {
    changed_ = true;
    log_.write(port::Level::warning, "node " + std::to_string(node.serial) + " cannot " + verb +
                                         " at " + place_text(node.position) + ": " +
                                         trouble_text(status));
  }
}

void MeshKeeper::activate_features_of(const NodeRecord& node) {
  for (const std::uint32_t number : features_.ending_at(node.serial)) try_feature(number);
}

void MeshKeeper::try_feature(std::uint32_t number) {
  const FeatureRecord& record = features_.records()[number];
  if (record.is_active()) return;
  const NodeRecord* from = roster_.find(record.settings.from);
  const NodeRecord* to = roster_.find(record.settings.to);
  if (from == nullptr || to == nullptr || !from->is_placed() || !to->is_placed()) return;
  FeatureId id;
  const Status status = mesh_.add_feature({.from = from->vertex, .to = to->vertex}, id);
  if (status == Status::ok) {
    features_.activate(number, id);
    changed_ = true;
    return;
  }
  const bool is_news = record.refusal != status;
  features_.refuse(number, status, epoch_);
  if (is_news) {
    changed_ = true;
    log_.write(port::Level::warning, features_.name(number) + " refused: " + trouble_text(status));
  }
}

std::string MeshKeeper::trouble_text(Status status) const {
  std::string text = explain(status);
  const Trouble& trouble = mesh_.trouble();
  if (!trouble.other.is_none())
    text += " [with " + features_.name(features_.number_of(trouble.other)) + "]";
  if (!trouble.vertex.is_none() && mesh_.kind(trouble.vertex) == VertexKind::node) {
    text += " [node " + std::to_string(serials_[trouble.vertex.value]) + "]";
  }
  return text;
}

}  // namespace etcm::firmware
