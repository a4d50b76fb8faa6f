// Nodes that stand so far from all others that a mistake is likelier than the place: a coordinate
// that is 0, longitude and latitude exchanged, another coordinate system.
#pragma once

#include <cstdint>
#include <vector>

#include "firmware/publish/snapshot.h"
#include "firmware/site/site_plane.h"

namespace etcm::firmware {

// Of fewer nodes nobody could say which of them stands apart.
inline constexpr std::size_t far_nodes_min = 4;
// So many times as far from the median place as three quarters of all are at the most ...
inline constexpr std::int64_t far_times = 20;
// ... and so many metres (in a plane without metres: what that counts in): stations that really
// are far from a yard stay below.
inline constexpr std::int64_t far_metres_min = 20'000;

class FarNodes {
 public:
  // All the memory it ever needs is taken here.
  explicit FarNodes(std::uint32_t vertices_max);

  void set_plane(const SitePlane& plane);

  // Sets is_far of the vertices, and the middle. The median place is that of the lower median of x
  // and that of y, so up to half of the nodes can be anywhere and not move it far. O(n) on average.
  void mark(Snapshot& snapshot);

 private:
  std::int64_t least_ = 0;  // units of the mesh
  std::vector<std::int64_t> sorted_;
};

}  // namespace etcm::firmware
