// Keeps the features and anchors of the site in the mesh: a feature while both of its ends are
// there, an anchor always. What the mesh rejects goes into quarantine, with its reason in the log.
#pragma once

#include "etcm/port/clock.h"
#include "etcm/port/log.h"
#include "firmware/config/settings.h"
#include "firmware/mesh/feature_keeper.h"
#include "firmware/mesh/kept_mesh.h"
#include "firmware/records/node_table.h"

namespace etcm::firmware {

class SiteKeeper {
 public:
  // The anchors are put in at once. All arguments must outlive this.
  SiteKeeper(KeptMesh& kept, const NodeTable& nodes, const port::Clock& clock, port::Log& log);

  FeatureKeeper& features() { return features_; }

  // Takes another site over: features that are no longer in it leave the mesh, anchors that are not
  // become obsolete. What is new comes in by place_anchors() and by settling the features.
  void replace_site(const Settings& settings);

  // Takes obsolete anchors out and puts missing ones in, as far as the mesh accepts that.
  void place_anchors();

 private:
  void try_anchor(AnchorRecord& anchor);
  void try_to_remove(AnchorRecord& anchor);
  bool note_answer(AnchorRecord& anchor, Status status);
  void report_rejection(const AnchorRecord& anchor, const char* what);

  KeptMesh& kept_;
  const NodeTable& nodes_;
  const port::Clock& clock_;
  port::Log& log_;
  FeatureKeeper features_;
};

}  // namespace etcm::firmware
