// The part of the keeper that follows the site: features, anchors and the domain as configured.
#include <algorithm>
#include <map>
#include <utility>

#include "firmware/mesh/mesh_keeper.h"

namespace etcm::firmware {

void MeshKeeper::update_site(std::uint32_t generation) {
  ++epoch_;
  retried_epoch_ = epoch_;
  changed_ = true;
  // Features leave before the anchors they end at, and come after them.
  update_features();
  anchors_.replace(settings_.anchors);
  expel_from_outside(generation);
  update_anchors();
  for (NodeRecord& node : nodes_.records()) {
    if (node.is_known() && !node.is_placed() && node.is_quarantined()) join(node, generation);
  }
  for (std::uint32_t number = 0; number < features_.records().size(); ++number) {
    try_feature(number);
  }
}

// What was in the mesh and still is configured keeps its id; the rest is taken out.
void MeshKeeper::update_features() {
  const auto ends_of = [](const FeatureSettings& feature) {
    return std::minmax({feature.from.key(), feature.to.key()});
  };
  FeatureTable next(settings_.features, mesh_.config().features_max);
  std::map<std::pair<std::uint64_t, std::uint64_t>, std::uint32_t> number_of;
  for (std::uint32_t number = 0; number < next.records().size(); ++number) {
    number_of.emplace(ends_of(next.records()[number].settings), number);
  }
  for (const FeatureRecord& record : features_.records()) {
    if (!record.is_active()) continue;
    if (const auto found = number_of.find(ends_of(record.settings)); found != number_of.end()) {
      next.activate(found->second, record.id);
    } else {
      // An active feature is one the mesh has, so nothing can be wrong with its id.
      static_cast<void>(mesh_.remove_feature(record.id));
    }
  }
  features_ = std::move(next);
}

void MeshKeeper::update_anchors() {
  for (AnchorRecord& anchor : anchors_.records()) {
    if (anchor.is_obsolete) try_to_remove(anchor);
  }
  anchors_.tidy();
  for (AnchorRecord& anchor : anchors_.records()) {
    if (!anchor.is_placed()) try_anchor(anchor);
  }
}

void MeshKeeper::try_anchor(AnchorRecord& anchor) {
  if (!anchor.rejection.is_none() && anchor.rejected_epoch == epoch_) return;
  Status status = mesh_.join(anchor.settings.position, anchor.vertex);
  if (status == Status::duplicate_vertex) {
    // The node that stands there.
    anchor.vertex = mesh_.error_detail().vertex;
    anchor.is_taken = true;
    status = Status::ok;
  }
  const bool is_news = anchor.rejection != status;
  if (is_news) anchor.rejected_since = clock_.now();
  anchor.rejection = status;
  anchor.rejected_epoch = epoch_;
  if (status == Status::ok) {
    if (!anchor.is_taken) serials_[anchor.vertex.value] = no_serial;
    activate_features_at(FeatureEnd::anchor(anchor.settings.position));
    changed_ = true;
  } else if (is_news) {
    changed_ = true;
    report_rejection(anchor, " is not in the mesh: ");
  }
}

void MeshKeeper::try_to_remove(AnchorRecord& anchor) {
  if (!anchor.rejection.is_none() && anchor.rejected_epoch == epoch_) return;
  const Status status = mesh_.leave(anchor.vertex);
  const bool is_news = anchor.rejection != status;
  if (is_news) anchor.rejected_since = clock_.now();
  anchor.rejection = status;
  anchor.rejected_epoch = epoch_;
  if (status == Status::ok) {
    anchor.vertex = VertexId::none();
    changed_ = true;
  } else if (is_news) {
    changed_ = true;
    report_rejection(anchor, " is no longer wanted, but the mesh needs it: ");
  }
}

void MeshKeeper::report_rejection(const AnchorRecord& anchor, const char* what) {
  TextLine line;
  line << name_of(anchor) << what;
  report_error_detail(line, anchor.rejection);
  log_.write(port::Level::warning, line);
}

void MeshKeeper::expel_from_outside(std::uint32_t generation) {
  for (NodeRecord& node : nodes_.records()) {
    if (!node.is_placed()) continue;
    const DomainPlace place = place_of(node.placed);
    if (place == DomainPlace::inside) continue;
    leave(node, "the domain has changed", generation);
    if (!node.is_placed()) reject(node, "stay", place, before());
  }
}

}  // namespace etcm::firmware
