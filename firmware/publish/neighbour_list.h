// The neighbours of a node, as they are written to it: by serial.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "firmware/publish/snapshot.h"

namespace etcm::firmware {

// The nodes that an edge of the mesh joins to it, and, where a feature leads from it to a Steiner
// vertex, the next node on that feature: a Steiner vertex has no serial and is only a proposal for
// a relay, but along the feature no node stands between the two. Other Steiner vertices are left
// out.
class NeighbourList {
 public:
  // All the memory it needs is taken here.
  explicit NeighbourList(std::uint32_t vertices_max) { list_.reserve(vertices_max); }

  // Of the node in this row. Ascending, each once; good until the next call. O(degree, and the
  // length of the features that leave the node).
  std::span<const Serial> of(const Snapshot& snapshot, std::uint32_t row);

 private:
  std::vector<Serial> list_;
};

}  // namespace etcm::firmware
