#include "firmware/mesh/site_keeper.h"

#include "firmware/logging/text_line.h"
#include "firmware/mesh/rejection_text.h"

namespace etcm::firmware {

SiteKeeper::SiteKeeper(KeptMesh& kept, const NodeTable& nodes, const port::Clock& clock,
                       port::Log& log)
    : kept_(kept), nodes_(nodes), clock_(clock), log_(log), features_(kept, nodes, clock, log) {
  place_anchors();
}

void SiteKeeper::replace_site(const Settings& settings) {
  // Features leave before the anchors they end at.
  features_.replace(settings.features);
  kept_.anchors().replace(settings.anchors);
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
    features_.note_place(anchor.settings.position);
    features_.activate_at(FeatureEnd::anchor(anchor.settings.position));
  } else if (is_news) {
    report_rejection(anchor, " is not in the mesh: ");
  }
}

void SiteKeeper::try_to_remove(AnchorRecord& anchor) {
  if (!anchor.rejection.is_none() && anchor.rejected_epoch == kept_.epoch()) return;
  Status status;
  do {
    status = kept_.mesh().leave(anchor.vertex, kept_.work_limit());
  } while (status != Status::ok && features_.give_way());
  const bool is_news = note_answer(anchor, status);
  if (status == Status::ok) {
    anchor.vertex = VertexId::none();
    features_.note_place(anchor.settings.position);
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

void SiteKeeper::report_rejection(const AnchorRecord& anchor, const char* what) {
  TextLine text;
  text << name_of(anchor) << what;
  write_rejection(text, kept_, nodes_, anchor.rejection);
  log_.write(port::Level::warning, text);
}

}  // namespace etcm::firmware
