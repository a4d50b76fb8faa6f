// Every question of analysis.h, domain.h and locate.h, asked of a mesh of any size and history:
// each must come back with an answer, and with that of brute force where that is quick.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "etcm/analysis.h"
#include "etcm/domain.h"
#include "etcm/mesh.h"
#include "inputs/random.h"
#include "support/meshes.h"

namespace etcm::test {

class AnalysisCheck {
 public:
  // Ranges, devices and places follow from the seed and from what was asked before. The devices
  // are a mesh of their own, emptied and built anew for each question.
  AnalysisCheck(std::uint32_t vertices_max, std::uint64_t seed);

  // Asks everything of a mesh of at most `vertices_max` vertices; its devices stand at some of its
  // nodes, at all of them, or at none.
  testing::AssertionResult of(const Mesh& mesh);

 private:
  void take_vertices(const Mesh& mesh);
  void place_devices(const Mesh& mesh);
  std::uint32_t random_range();

  testing::AssertionResult places(const Mesh& mesh);
  testing::AssertionResult edges(const Mesh& mesh);
  testing::AssertionResult network(const Mesh& mesh);
  testing::AssertionResult features(const Mesh& mesh);
  testing::AssertionResult coverage(const Mesh& mesh);
  testing::AssertionResult coverage_in(const Mesh& sensors, const Mesh* where, Exterior exterior);
  testing::AssertionResult is_seen(const Mesh& sensors, const Domain& domain, std::uint32_t range);

  inputs::Random random_;
  OwnedMesh devices_;
  std::vector<VertexId> vertices_;  // of the mesh that is asked
  std::vector<Point> points_;
  std::vector<Region> region_;
  std::vector<TriangleId> waiting_;
  std::vector<ConnectivityScratch> parts_;
  std::vector<std::int32_t> readings_;
};

}  // namespace etcm::test
