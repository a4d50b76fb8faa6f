// Keeps the features and anchors of the site in the mesh: a feature while both of its ends are
// there, an anchor always. What the mesh rejects goes into quarantine, with its reason in the log.
#pragma once

#include <cstdint>
#include <span>

#include "etcm/port/clock.h"
#include "etcm/port/log.h"
#include "firmware/config/settings.h"
#include "firmware/logging/text_line.h"
#include "firmware/mesh/kept_mesh.h"
#include "firmware/records/node_table.h"

namespace etcm::firmware {

class SiteKeeper {
 public:
  // The anchors are put in at once. All arguments must outlive this.
  SiteKeeper(KeptMesh& kept, NodeTable& nodes, const port::Clock& clock, port::Log& log);

  // Takes another site over: features that are no longer in it leave the mesh, anchors that are not
  // become obsolete. What is new comes in by place_anchors() and try_features().
  void replace_site(const Settings& settings);

  // Takes obsolete anchors out and puts missing ones in, as far as the mesh accepts that.
  void place_anchors();
  // Puts in each feature whose ends are there.
  void try_features();
  // The same for those that were rejected.
  void retry_features();

  // The end is in the mesh now, or is about to leave.
  void activate_features_at(const FeatureEnd& end);
  void remove_features_at(const FeatureEnd& end);

  // Adds to a line of the log why the mesh has just rejected something.
  void report_error_detail(TextLine& text, const Rejection& rejection) const;

 private:
  void replace_features(std::span<const FeatureSettings> features);
  void try_feature(std::uint32_t number);
  void try_anchor(AnchorRecord& anchor);
  void try_to_remove(AnchorRecord& anchor);
  bool note_answer(AnchorRecord& anchor, Status status);
  void report_rejection(const AnchorRecord& anchor, const char* what);
  VertexId vertex_at(const FeatureEnd& end) const;

  KeptMesh& kept_;
  NodeTable& nodes_;
  const port::Clock& clock_;
  port::Log& log_;
};

}  // namespace etcm::firmware
