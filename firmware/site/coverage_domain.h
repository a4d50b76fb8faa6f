// Where coverage is asked for: the domain of the site, or what the features of the mesh enclose.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "etcm/analysis.h"
#include "etcm/domain.h"
#include "etcm/mesh.h"
#include "firmware/site/site_domain.h"

namespace etcm::firmware {

class CoverageDomain {
 public:
  // Takes the memory to label meshes of at most so many vertices.
  explicit CoverageDomain(std::uint32_t vertices_max);

  // Takes a site over, and memory as its outline and holes need it. They must be such that a mesh
  // can follow them; the answer is that mesh's. Where it is not ok, the site counts as one without
  // outline and holes.
  Status take(const SiteDomain& site);

  // With an outline: what is within it and in no hole, whatever stands in the mesh. Without: what
  // closed features of the mesh enclose, where every vertex is on or within them; else its hull;
  // less the holes while all of their edges are in the mesh. Good until the mesh changes. O(n), or
  // O(1) with an outline.
  Domain of(const Mesh& mesh);

 private:
  Status build();
  void label(const SiteDomain& site);
  bool has_all_holes(const Mesh& mesh);
  bool has_edge(const Mesh& mesh, const DomainEdge& edge);

  // The outline and the holes alone, as a mesh.
  std::vector<Position> corners_;
  std::vector<FeatureEnds> edges_;
  std::vector<std::uint64_t> memory_;
  Mesh outline_mesh_;
  std::vector<Region> outline_region_;
  bool has_outline_ = false;

  std::vector<DomainEdge> hole_edges_;
  std::vector<Point> hole_seeds_;

  // Of the mesh that is asked for.
  std::vector<Region> region_;
  std::vector<TriangleId> waiting_;
  std::vector<Neighbour> around_;
};

}  // namespace etcm::firmware
