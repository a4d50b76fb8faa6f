#include "firmware/publish/neighbour_list.h"

#include <algorithm>
#include <utility>

namespace etcm::firmware {

std::span<const Serial> NeighbourList::of(const Snapshot& snapshot, std::uint32_t row) {
  list_.clear();
  for (const SnapshotNeighbour& neighbour : neighbours_of(snapshot, row)) {
    std::uint32_t from = row;
    std::uint32_t at = neighbour.row;
    if (snapshot.vertices[at].kind == VertexKind::steiner && !neighbour.constrained) continue;
    while (at != no_row && snapshot.vertices[at].kind == VertexKind::steiner) {
      at = next_on_feature(snapshot, std::exchange(from, at), at);
    }
    // An anchor cannot be asked.
    if (at == no_row || snapshot.vertices[at].is_anchor) continue;
    list_.push_back(snapshot.vertices[at].serial);
  }
  std::sort(list_.begin(), list_.end());
  list_.erase(std::unique(list_.begin(), list_.end()), list_.end());
  return list_;
}

}  // namespace etcm::firmware
