// A snapshot as the writers of files take a mesh.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "etcm/files/mesh_image.h"
#include "firmware/config/settings.h"
#include "firmware/publish/reading_snapshot.h"
#include "firmware/publish/snapshot.h"
#include "firmware/publish/snapshot_domain.h"
#include "firmware/site/site_plane.h"

namespace etcm::firmware {

// Makes images of snapshots, one after the other into the same memory.
class SnapshotImager {
 public:
  // All the memory that it needs for these settings is taken here.
  explicit SnapshotImager(const Settings& settings);

  // The nodes by row, each with its serial (an anchor with -1), and then the Steiner vertices along
  // the features, those at the first node first. Equal meshes whose nodes stand in the same rows
  // give equal images. Serials and what nodes measure are values. Good until the next call. O(n log
  // n), and O(degree^2) of each vertex. With the degrees of all vertices where the plane has them.
  std::shared_ptr<const files::MeshImage> make(const Snapshot& snapshot,
                                               const ReadingSnapshot& readings,
                                               const SitePlane& plane);

 private:
  void take_names(const ReadingSnapshot& readings);
  void add_vertex(const Snapshot& snapshot, std::uint32_t row);
  void add_values(const Snapshot& snapshot, const ReadingSnapshot& readings);
  void add_degrees(const SitePlane& plane);
  void add_segments(const Snapshot& snapshot, std::uint32_t node);
  void add_edges_and_triangles(const Snapshot& snapshot, std::uint32_t index);

  std::shared_ptr<files::MeshImage> image_;
  std::uint32_t serial_name_ = 0;
  SnapshotDomain domain_;
  std::vector<std::uint32_t> index_of_;  // by row
  std::vector<std::uint32_t> row_of_;    // by index
  // The segments of one node: the index of the other end, and the row of the first vertex on it.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> segments_;
};

}  // namespace etcm::firmware
