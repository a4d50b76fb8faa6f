#include "firmware/publish/snapshot.h"

namespace etcm::firmware {

// Two edges of the feature end at a Steiner vertex, and no edge of another one does.
std::uint32_t next_on_feature(const Snapshot& snapshot, std::uint32_t from, std::uint32_t over) {
  for (const SnapshotNeighbour& neighbour : neighbours_of(snapshot, over)) {
    if (neighbour.constrained && neighbour.row != from) return neighbour.row;
  }
  return no_row;
}

}  // namespace etcm::firmware
