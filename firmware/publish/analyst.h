// Asks a mesh what the operator wants to know of it (etcm/analysis.h), into memory taken once.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "etcm/analysis.h"
#include "firmware/config/settings.h"
#include "firmware/publish/snapshot.h"
#include "firmware/records/feature_table.h"
#include "firmware/site/coverage_domain.h"

namespace etcm::firmware {

// Takes its memory at once.
void reserve(MeshAnalysis& analysis, const AnalysisSettings& settings);

class Analyst {
 public:
  // For meshes of this configuration.
  Analyst(const AnalysisSettings& settings, const MeshConfig& config);

  // Another site; takes what memory its outline needs. REQUIRES: it has been checked (check_site).
  void take_site(const SiteDomain& site);

  // Fills snapshot.analysis, and the subgraphs in snapshot.neighbours. The snapshot is of this
  // mesh, and its nodes that are no anchors are the devices. O(n log n): a few microseconds a
  // vertex.
  void look_at(const Mesh& mesh, const FeatureTable& features, Snapshot& snapshot);

 private:
  const Mesh& devices_alone(const Mesh& mesh, const Snapshot& snapshot);
  void look_at_links(const Mesh& mesh, const Mesh& devices, MeshAnalysis& analysis);
  void look_at_relays(const Mesh& mesh, const Mesh& devices, const FeatureTable& features,
                      MeshAnalysis& analysis);
  void look_at_coverage(const Mesh& mesh, const Mesh& devices, MeshAnalysis& analysis);
  void look_at_gaps(const Mesh& mesh, const Mesh& devices, const FeatureTable& features,
                    MeshAnalysis& analysis);
  void mark_subgraphs(const Mesh& mesh, Snapshot& snapshot);

  const AnalysisSettings settings_;
  std::vector<std::uint64_t> devices_memory_;
  Mesh devices_mesh_;
  std::vector<Position> positions_;        // of the devices
  std::vector<std::uint32_t> device_row_;  // in the snapshot, by device
  CoverageDomain domain_;
  std::vector<ConnectivityScratch> parts_;
  std::vector<Link> links_;
  std::vector<Relay> relays_;
  std::vector<Gap> gaps_;
  std::vector<Hole> holes_;
};

}  // namespace etcm::firmware
