#include "firmware/mesh/site_keeper.h"

#include <algorithm>
#include <map>
#include <utility>

namespace etcm::firmware {

SiteKeeper::SiteKeeper(KeptMesh& kept, NodeTable& nodes, const port::Clock& clock, port::Log& log)
    : kept_(kept), nodes_(nodes), clock_(clock), log_(log) {
  place_anchors();
}

void SiteKeeper::replace_site(const Settings& settings) {
  // Features leave before the anchors they end at.
  replace_features(settings.features);
  kept_.anchors().replace(settings.anchors);
}

// What was in the mesh and still is configured keeps its id; the rest is taken out.
void SiteKeeper::replace_features(std::span<const FeatureSettings> features) {
  const auto ends_of = [](const FeatureSettings& feature) {
    return std::minmax({feature.from.key(), feature.to.key()});
  };
  Mesh& mesh = kept_.mesh();
  FeatureTable next(features, mesh.config().features_max);
  std::map<std::pair<std::uint64_t, std::uint64_t>, std::uint32_t> number_of;
  for (std::uint32_t number = 0; number < next.records().size(); ++number) {
    number_of.emplace(ends_of(next.records()[number].settings), number);
  }
  for (const FeatureRecord& record : kept_.features().records()) {
    if (!record.is_active()) continue;
    if (const auto found = number_of.find(ends_of(record.settings)); found != number_of.end()) {
      next.activate(found->second, record.id);
    } else {
      // An active feature is one the mesh has, so nothing can be wrong with its id.
      static_cast<void>(mesh.remove_feature(record.id));
    }
  }
  kept_.features() = std::move(next);
}

void SiteKeeper::place_anchors() {
  for (AnchorRecord& anchor : kept_.anchors().records()) {
    if (anchor.is_obsolete) try_to_remove(anchor);
  }
  kept_.anchors().tidy();
  for (AnchorRecord& anchor : kept_.anchors().records()) {
    if (!anchor.is_placed()) try_anchor(anchor);
  }
}

void SiteKeeper::try_anchor(AnchorRecord& anchor) {
  if (!anchor.rejection.is_none() && anchor.rejected_epoch == kept_.epoch()) return;
  Status status = kept_.mesh().join(anchor.settings.position, anchor.vertex, kept_.work_limit());
  if (status == Status::duplicate_vertex) {
    // The node that stands there.
    anchor.vertex = kept_.mesh().error_detail().vertex;
    anchor.is_taken = true;
    status = Status::ok;
  }
  const bool is_news = note_answer(anchor, status);
  if (status == Status::ok) {
    if (!anchor.is_taken) kept_.set_serial(anchor.vertex, Serial::none());
    activate_features_at(FeatureEnd::anchor(anchor.settings.position));
  } else if (is_news) {
    report_rejection(anchor, " is not in the mesh: ");
  }
}

void SiteKeeper::try_to_remove(AnchorRecord& anchor) {
  if (!anchor.rejection.is_none() && anchor.rejected_epoch == kept_.epoch()) return;
  const Status status = kept_.mesh().leave(anchor.vertex, kept_.work_limit());
  const bool is_news = note_answer(anchor, status);
  if (status == Status::ok) {
    anchor.vertex = VertexId::none();
  } else if (is_news) {
    report_rejection(anchor, " is no longer wanted, but the mesh needs it: ");
  }
}

// Whether the mesh gives another answer than before.
bool SiteKeeper::note_answer(AnchorRecord& anchor, Status status) {
  const bool is_news = anchor.rejection != status;
  if (is_news) anchor.rejected_since = clock_.now();
  if (is_news || status == Status::ok) kept_.mark_changed();
  anchor.rejection = status;
  anchor.rejected_epoch = kept_.epoch();
  return is_news;
}

void SiteKeeper::try_features() {
  for (std::uint32_t number = 0; number < kept_.features().records().size(); ++number) {
    try_feature(number);
  }
}

void SiteKeeper::retry_features() {
  const FeatureTable& features = kept_.features();
  for (std::uint32_t number = 0; number < features.records().size(); ++number) {
    if (features.rejected_count() == 0) break;
    if (features.records()[number].rejection != Status::ok) try_feature(number);
  }
}

void SiteKeeper::activate_features_at(const FeatureEnd& end) {
  for (const std::uint32_t number : kept_.features().ending_at(end)) try_feature(number);
}

void SiteKeeper::remove_features_at(const FeatureEnd& end) {
  FeatureTable& features = kept_.features();
  for (const std::uint32_t number : features.ending_at(end)) {
    const FeatureRecord& feature = features.records()[number];
    // An active feature is one the mesh has, so nothing can be wrong with its id.
    if (feature.is_active()) static_cast<void>(kept_.mesh().remove_feature(feature.id));
    features.deactivate(number);
  }
}

void SiteKeeper::try_feature(std::uint32_t number) {
  FeatureTable& features = kept_.features();
  const FeatureRecord& record = features.records()[number];
  if (record.is_active()) return;
  const FeatureEnds ends{.from = vertex_at(record.settings.from),
                         .to = vertex_at(record.settings.to)};
  if (ends.from.is_none() || ends.to.is_none()) return;
  FeatureId id;
  const Status status = kept_.mesh().add_feature(ends, id, kept_.work_limit());
  if (status == Status::ok) {
    features.activate(number, id);
    kept_.mark_changed();
    return;
  }
  const bool is_news = record.rejection != status;
  features.reject(number, status, kept_.epoch(), clock_.now());
  if (!is_news) return;
  kept_.mark_changed();
  TextLine text;
  text << features.name(number) << " refused: ";
  report_error_detail(text, status);
  log_.write(port::Level::warning, text);
}

VertexId SiteKeeper::vertex_at(const FeatureEnd& end) const {
  if (end.is_anchor) {
    const AnchorRecord* const anchor = std::as_const(kept_).anchors().find(end.position);
    return anchor == nullptr ? VertexId::none() : anchor->vertex;
  }
  const NodeRecord* const node = nodes_.find(end.serial);
  return node == nullptr ? VertexId::none() : node->vertex;
}

void SiteKeeper::report_rejection(const AnchorRecord& anchor, const char* what) {
  TextLine text;
  text << name_of(anchor) << what;
  report_error_detail(text, anchor.rejection);
  log_.write(port::Level::warning, text);
}

void SiteKeeper::report_error_detail(TextLine& text, const Rejection& rejection) const {
  text << explain(rejection);
  if (rejection.mesh == Status::ok) return;
  const KeptMesh& kept = kept_;
  const ErrorDetail& detail = kept.mesh().error_detail();
  if (!detail.other.is_none()) {
    text << " [with " << kept.features().name(kept.features().number_of(detail.other)) << "]";
  }
  if (!detail.vertex.is_none() && kept.mesh().kind(detail.vertex) == VertexKind::node) {
    const Serial serial = kept.serial_of(detail.vertex);
    const AnchorRecord* const anchor = kept.anchors().find(kept.mesh().position(detail.vertex));
    if (!serial.is_none()) {
      text << " [node " << serial.value << "]";
    } else if (anchor != nullptr) {
      text << " [" << name_of(*anchor) << "]";
    }
  }
}

}  // namespace etcm::firmware
