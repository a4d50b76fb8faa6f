// What a generation of the mesh tells an operator, as far as the settings ask for it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "etcm/types.h"
#include "firmware/protocol/mesh_register_layout.h"

namespace etcm::firmware {

inline constexpr std::uint32_t no_row = 0xffffffffu;

// Rows are those of the snapshot, features count from 1 as configured.
struct LongLink {
  std::uint32_t from_row = 0;
  std::uint32_t to_row = 0;
};

struct ProposedRelay {
  Point point;
  std::uint32_t feature = 0;   // 0: an anchor that is on none
  std::uint32_t row = no_row;  // of the Steiner vertex or the anchor that stands there
};

struct CoverageHole {
  Point point;
  std::uint32_t distance = 0;  // to the nearest node, in whole units, rounded up
  bool on_boundary = false;
};

struct BarrierGap {
  std::uint32_t feature = 0;
  std::uint32_t from_row = 0;  // of a device on the feature, or of its end
  std::uint32_t to_row = 0;
  bool watched = false;  // devices beside the feature see all of it
};

// Devices are the nodes that are no anchors. "Alone": the network as it stands. "With relays": with
// one at each Steiner vertex and each anchor.
struct MeshAnalysis {
  std::uint32_t radio_range = 0;        // 0: not asked for; then what follows is empty
  std::uint32_t least_range_alone = 0;  // that keeps the network in one
  std::uint32_t least_range_with_relays = 0;
  std::uint32_t parts_alone = 0;  // into which it falls at radio_range
  std::uint32_t parts_with_relays = 0;
  std::uint32_t long_link_count = 0;  // between devices that are neighbours
  std::uint32_t relay_count = 0;      // Steiner vertices, anchors, and more on long subsegments
  std::vector<LongLink> long_links;
  std::vector<ProposedRelay> relays;

  std::uint32_t sensing_range = 0;  // 0: not asked for; then what follows is empty
  std::uint32_t hole_count = 0;     // worst places beyond it; 0: all of the domain is seen
  std::uint32_t gap_count = 0;
  std::uint32_t unwatched_gap_count = 0;  // among the first analysis_list_max
  std::vector<CoverageHole> holes;
  std::vector<BarrierGap> gaps;
};

}  // namespace etcm::firmware
