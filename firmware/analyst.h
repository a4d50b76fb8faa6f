// Asks a mesh what the operator wants to know of it (etcm/analysis.h), into memory taken once.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "etcm/analysis.h"
#include "feature_book.h"
#include "settings.h"
#include "snapshot.h"

namespace etcm::firmware {

// Takes its memory at once.
void reserve(MeshAnalysis& analysis, const AnalysisSettings& settings);

class Analyst {
 public:
  // For meshes of this configuration.
  Analyst(const AnalysisSettings& settings, const MeshConfig& config);

  // Fills snapshot.analysis, and the subgraphs in snapshot.neighbours. The snapshot is of this
  // mesh. O(n log n): a few microseconds a vertex.
  void look_at(const Mesh& mesh, const FeatureBook& features, Snapshot& snapshot);

 private:
  const Mesh& nodes_alone(const Mesh& mesh);
  void look_at_links(const Mesh& mesh, const Mesh& nodes, MeshAnalysis& analysis);
  void look_at_relays(const Mesh& mesh, const FeatureBook& features, MeshAnalysis& analysis);
  void look_at_coverage(const Mesh& mesh, const Mesh& nodes, MeshAnalysis& analysis);
  void look_at_gaps(const Mesh& mesh, const Mesh& nodes, const FeatureBook& features,
                    MeshAnalysis& analysis);
  void mark_subgraphs(const Mesh& mesh, Snapshot& snapshot);

  const AnalysisSettings settings_;
  std::vector<std::uint64_t> nodes_memory_;
  Mesh nodes_mesh_;  // of the nodes alone
  std::vector<Position> positions_;
  std::vector<ConnectivityScratch> parts_;
  std::vector<Region> region_;
  std::vector<TriangleId> waiting_;
  std::vector<Link> links_;
  std::vector<Relay> relays_;
  std::vector<Gap> gaps_;
  std::vector<Hole> holes_;
};

}  // namespace etcm::firmware
