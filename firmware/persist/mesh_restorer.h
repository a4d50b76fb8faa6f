// Makes the mesh of an earlier run again, as far as the site is still the same.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "etcm/mesh.h"
#include "firmware/mesh/kept_mesh.h"
#include "firmware/mesh/site_keeper.h"
#include "firmware/persist/saved_state.h"
#include "firmware/records/node_table.h"
#include "firmware/site/site_domain.h"

namespace etcm::firmware {

class MeshRestorer {
 public:
  // No node is in the mesh. All arguments must outlive this.
  MeshRestorer(KeptMesh& kept, SiteKeeper& site, const SiteDomain& domain)
      : kept_(kept), site_(site), domain_(domain) {}

  // `nodes` are the records of the saved nodes, null for one without. False where the mesh is not
  // the same: all nodes are in it then, as build() joins them today, or none is.
  bool restore(const SavedState& saved, std::span<NodeRecord* const> nodes);

 private:
  Status make_mesh(const SavedState& saved);
  bool find_positions(const SavedState& saved);
  bool find_features(const SavedState& saved);
  void assign_vertices(const SavedState& saved, std::span<NodeRecord* const> nodes);

  KeptMesh& kept_;
  SiteKeeper& site_;
  const SiteDomain& domain_;
  // What the mesh is restored from: nodes, and after them anchors.
  std::vector<Position> positions_;
  std::vector<std::array<std::uint64_t, 2>> keys_;  // of a node, and of an anchor it stands on
  std::vector<FeatureEnds> ends_;
  std::vector<std::uint32_t> numbers_;  // of the features, as configured
};

}  // namespace etcm::firmware
