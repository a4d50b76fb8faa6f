#include "firmware/mesh/mesh_keeper.h"

#include <algorithm>

namespace etcm::firmware {

namespace {

TextLine& operator<<(TextLine& line, Position position) {
  return line << "(" << position.x << ", " << position.y << ")";
}

struct Counted {
  std::uint32_t count;
  const char* one;
  const char* many;
};

TextLine& operator<<(TextLine& line, const Counted& counted) {
  return line << counted.count << " " << (counted.count == 1 ? counted.one : counted.many);
}

}  // namespace

MeshKeeper::MeshKeeper(Mesh& mesh, const Settings& settings, NodeTable& nodes,
                       const port::Clock& clock, port::Log& log)
    : mesh_(mesh),
      settings_(settings),
      nodes_(nodes),
      clock_(clock),
      log_(log),
      features_(settings.features, mesh.config().features_max),
      anchors_(settings.anchors),
      serials_(mesh.config().vertices_max + 1, no_serial) {
  update_anchors();
}

void MeshKeeper::join(NodeRecord& node, std::uint32_t generation) {
  if (!is_worth_a_try(node)) return;
  const Before start = before();
  if (const DomainPlace place = place_of(node.position); place != DomainPlace::inside) {
    return reject(node, "join", place, start);
  }
  const AnchorRecord* const anchor = anchors_.find(node.position);
  const bool is_vacant = anchor != nullptr && anchor->is_vacant();
  VertexId id;
  if (is_vacant) {
    id = anchor->vertex;
  } else if (const Status status = mesh_.join(node.position, id); status != Status::ok) {
    return reject(node, "join", status, start);
  }
  seat(node, id);
  activate_features_at(node.serial);
  TextLine line;
  line << "node " << node.serial << " joined at " << node.placed
       << (is_vacant ? ", on the anchor" : "") << ": generation " << generation << ", "
       << Counted{mesh_.neighbours(id, {}), "neighbour", "neighbours"};
  tell_difference(line, start);
  log_.write(port::Level::info, line);
}

void MeshKeeper::move(NodeRecord& node, std::uint32_t generation) {
  if (!is_worth_a_try(node)) return;
  const Before start = before();
  if (const DomainPlace place = place_of(node.position); place != DomainPlace::inside) {
    return reject(node, "move", place, start);
  }
  const Position from = node.placed;
  AnchorRecord* const left = anchor_of(node);
  AnchorRecord* const reached = anchors_.find(node.position);
  const bool is_vacant = reached != nullptr && reached->is_vacant();
  Status status = Status::ok;
  if (left == nullptr && !is_vacant) {
    status = mesh_.move(node.vertex, node.position);
  } else if (left != reached) {
    status = change_vertex(node, left, is_vacant ? reached : nullptr);
  }
  if (status != Status::ok) return reject(node, "move", status, start);
  seat(node, node.vertex);
  ++epoch_;
  TextLine line;
  line << "node " << node.serial << " moved from " << from << " to " << node.placed
       << ": generation " << generation;
  tell_difference(line, start);
  log_.write(port::Level::info, line);
}

void MeshKeeper::leave(NodeRecord& node, const char* why, std::uint32_t generation) {
  const Before start = before();
  remove_features_at(node.serial);
  const bool lost_features = features_.active_count() != start.features_active;
  // The mesh would only say the same again.
  if (node.leave_rejected && node.rejected_epoch == epoch_ && !lost_features) return;
  AnchorRecord* const anchor = anchor_of(node);
  if (anchor != nullptr) anchor->is_taken = false;
  const Status status = anchor != nullptr ? Status::ok : mesh_.leave(node.vertex);
  node.leave_rejected = status != Status::ok;
  // A rejection alone makes room for nobody.
  if (!node.leave_rejected || lost_features) {
    ++epoch_;
    changed_ = true;
  }
  if (node.leave_rejected) return reject(node, "leave", status, start);
  serials_[node.vertex.value] = no_serial;
  node.vertex = VertexId::none();
  node.rejection = {};
  TextLine line;
  line << "node " << node.serial << " left (" << why << "): generation " << generation;
  tell_difference(line, start);
  log_.write(port::Level::info, line);
}

void MeshKeeper::stay(NodeRecord& node) {
  // One outside the domain is not wanted.
  if (!node.leave_rejected || place_of(node.placed) != DomainPlace::inside) return;
  node.leave_rejected = false;
  clear_rejection(node);
  activate_features_at(node.serial);
}

void MeshKeeper::clear_rejection(NodeRecord& node) {
  if (!node.is_quarantined()) return;
  node.rejection = {};
  changed_ = true;
}

void MeshKeeper::retry_rejected(std::uint32_t generation) {
  const port::Instant started = clock_.now();
  if (started < next_deadline()) return;
  retried_epoch_ = epoch_;
  for (NodeRecord& node : nodes_.records()) {
    if (node.is_known() && !node.is_placed() && node.is_quarantined()) join(node, generation);
  }
  update_anchors();
  for (std::uint32_t number = 0; number < features_.records().size(); ++number) {
    if (features_.rejected_count() == 0) break;
    if (features_.records()[number].rejection != Status::ok) try_feature(number);
  }
  const port::Instant ended = clock_.now();
  retry_due_ = ended + retry_share * (ended - started);
}

bool MeshKeeper::is_short_of_room() const {
  return std::any_of(nodes_.records().begin(), nodes_.records().end(),
                     [](const NodeRecord& node) { return is_want_of_room(node.rejection); }) ||
         std::any_of(
             anchors_.records().begin(), anchors_.records().end(),
             [](const AnchorRecord& anchor) { return is_want_of_room(anchor.rejection); }) ||
         std::any_of(
             features_.records().begin(), features_.records().end(),
             [](const FeatureRecord& feature) { return is_want_of_room(feature.rejection); });
}

MeshKeeper::Before MeshKeeper::before() const {
  return {.at = clock_.now(),
          .steiner_count = mesh_.steiner_count(),
          .features_active = features_.active_count()};
}

port::Duration MeshKeeper::note_time(const Before& start) {
  ++times_.changes;
  times_.last = clock_.now() - start.at;
  times_.longest = std::max(times_.longest, times_.last);
  times_.total += times_.last;
  return times_.last;
}

void MeshKeeper::tell_difference(TextLine& line, const Before& start) {
  const std::uint32_t steiner = mesh_.steiner_count();
  const std::uint32_t active = features_.active_count();
  if (steiner < start.steiner_count) {
    line << ", " << Counted{start.steiner_count - steiner, "Steiner vertex", "Steiner vertices"}
         << " taken out";
  } else {
    line << ", " << Counted{steiner - start.steiner_count, "Steiner vertex", "Steiner vertices"}
         << " added";
  }
  if (active > start.features_active) {
    line << ", " << Counted{active - start.features_active, "feature", "features"} << " active";
  } else if (active < start.features_active) {
    line << ", " << Counted{start.features_active - active, "feature", "features"} << " waiting";
  }
  const std::int64_t tenths = note_time(start) / std::chrono::nanoseconds(100);
  line << ", " << tenths / 10 << "." << tenths % 10 << " us";
}

// The mesh would only say the same again.
bool MeshKeeper::is_worth_a_try(const NodeRecord& node) const {
  return !node.is_quarantined() || node.rejected_at != node.position ||
         node.rejected_epoch != epoch_;
}

void MeshKeeper::reject(NodeRecord& node, const char* verb, const Rejection& rejection,
                        const Before& start) {
  note_time(start);
  const bool is_news = node.rejection != rejection || node.rejected_at != node.position;
  if (node.rejection != rejection) node.rejected_since = clock_.now();
  node.rejection = rejection;
  node.rejected_at = node.position;
  node.rejected_epoch = epoch_;
  if (is_news) {
    changed_ = true;
    TextLine line;
    line << "node " << node.serial << " cannot " << verb << " at " << node.position << ": ";
    report_error_detail(line, rejection);
    log_.write(port::Level::warning, line);
  }
}

AnchorRecord* MeshKeeper::anchor_of(const NodeRecord& node) {
  AnchorRecord* const anchor = anchors_.find(node.placed);
  return anchor != nullptr && anchor->is_taken && anchor->vertex == node.vertex ? anchor : nullptr;
}

void MeshKeeper::seat(NodeRecord& node, VertexId id) {
  changed_ = true;
  node.vertex = id;
  node.placed = node.position;
  node.rejection = {};
  serials_[id.value] = node.serial;
  if (AnchorRecord* const anchor = anchors_.find(node.placed); anchor != nullptr) {
    // One that is no longer wanted leaves the vertex to the node.
    anchor->is_taken = !anchor->is_obsolete;
    anchor->vertex = anchor->is_obsolete ? VertexId::none() : id;
    anchor->rejection = {};
    activate_features_at(FeatureEnd::anchor(node.placed));
  }
}

// All or nothing, but for features that the mesh cannot take again: these are rejected for
// themselves.
Status MeshKeeper::change_vertex(NodeRecord& node, AnchorRecord* from, AnchorRecord* to) {
  VertexId id;
  if (to == nullptr) {
    const Status status = mesh_.join(node.position, id);
    if (status != Status::ok) return status;
  } else {
    id = to->vertex;
  }
  remove_features_at(node.serial);
  if (from != nullptr) {
    from->is_taken = false;
  } else if (const Status status = mesh_.leave(node.vertex); status != Status::ok) {
    activate_features_at(node.serial);
    return status;
  }
  serials_[node.vertex.value] = no_serial;
  node.vertex = id;
  activate_features_at(node.serial);
  return Status::ok;
}

void MeshKeeper::remove_features_at(const FeatureEnd& end) {
  for (const std::uint32_t number : features_.ending_at(end)) {
    const FeatureRecord& feature = features_.records()[number];
    // An active feature is one the mesh has, so nothing can be wrong with its id.
    if (feature.is_active()) static_cast<void>(mesh_.remove_feature(feature.id));
    features_.deactivate(number);
  }
}

void MeshKeeper::activate_features_at(const FeatureEnd& end) {
  for (const std::uint32_t number : features_.ending_at(end)) try_feature(number);
}

void MeshKeeper::try_feature(std::uint32_t number) {
  const FeatureRecord& record = features_.records()[number];
  if (record.is_active()) return;
  const FeatureEnds ends{.from = vertex_at(record.settings.from),
                         .to = vertex_at(record.settings.to)};
  if (ends.from.is_none() || ends.to.is_none()) return;
  FeatureId id;
  const Status status = mesh_.add_feature(ends, id);
  if (status == Status::ok) {
    features_.activate(number, id);
    changed_ = true;
    return;
  }
  const bool is_news = record.rejection != status;
  features_.reject(number, status, epoch_, clock_.now());
  if (is_news) {
    changed_ = true;
    TextLine line;
    line << features_.name(number) << " refused: ";
    report_error_detail(line, status);
    log_.write(port::Level::warning, line);
  }
}

VertexId MeshKeeper::vertex_at(const FeatureEnd& end) const {
  if (end.is_anchor) {
    const AnchorRecord* const anchor = anchors_.find(end.position);
    return anchor == nullptr ? VertexId::none() : anchor->vertex;
  }
  const NodeRecord* const node = nodes_.find(end.serial);
  return node == nullptr ? VertexId::none() : node->vertex;
}

void MeshKeeper::report_error_detail(TextLine& line, const Rejection& rejection) const {
  line << explain(rejection);
  if (rejection.mesh == Status::ok) return;
  const ErrorDetail& error_detail = mesh_.error_detail();
  if (!error_detail.other.is_none()) {
    line << " [with " << features_.name(features_.number_of(error_detail.other)) << "]";
  }
  if (!error_detail.vertex.is_none() && mesh_.kind(error_detail.vertex) == VertexKind::node) {
    const std::uint32_t serial = serials_[error_detail.vertex.value];
    const AnchorRecord* const anchor = anchors_.find(mesh_.position(error_detail.vertex));
    if (serial != no_serial) {
      line << " [node " << serial << "]";
    } else if (anchor != nullptr) {
      line << " [" << name_of(*anchor) << "]";
    }
  }
}

}  // namespace etcm::firmware
