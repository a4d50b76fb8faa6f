// Nodes that stand so far from the site, or from all others, that a mistake is likelier than the
// place: a coordinate that is 0, words of a number or longitude and latitude exchanged, another
// coordinate system.
//
// What the settings say is a truth of its own: where nodes were surveyed, the fixed points and the
// outline of the site, its origin. It counts where more than half of it is in one place.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "firmware/config/settings.h"
#include "firmware/publish/snapshot.h"
#include "firmware/site/site_plane.h"

namespace etcm::firmware {

// ---- In metres; not in a plane of which nobody has said how long its units are.

// From the site: the horizon of the highest masts is some 100 km away, and what moves comes back.
inline constexpr std::int64_t far_from_site_metres = 200'000;
// One place ends where there is nothing for so long: no radio and no line of one site bridges that.
inline constexpr std::int64_t one_place_metres = 1'000'000;

// ---- From the median place of all nodes.

// Of fewer nodes nobody could say which of them stands apart.
inline constexpr std::size_t far_nodes_min = 4;
// So many times as far from the median place as three quarters of all are at the most ...
inline constexpr std::int64_t far_times = 20;
// ... and so many metres (in a plane without metres: what that counts in): stations that really
// are far from a yard stay below.
inline constexpr std::int64_t far_metres_min = 20'000;

class FarNodes {
 public:
  // All the memory that mark() needs is taken here.
  explicit FarNodes(std::uint32_t vertices_max);

  // Takes its memory.
  void set_site(const Settings& settings);

  // Sets how far from what each vertex is, and the middle. The median place is that of the lower
  // median of x and that of y, so up to half of the nodes can be anywhere and not move it far. O(n)
  // on average, and O(n log n) where nodes are 1000 km apart.
  void mark(Snapshot& snapshot);

 private:
  // Places without a gap between them that is too wide for a site.
  struct Box {
    std::int64_t left = 0;
    std::int64_t right = 0;
    std::int64_t bottom = 0;
    std::int64_t top = 0;
    bool contains(Position place) const;
    std::int64_t squared_distance_to(Position place) const;
  };

  std::optional<Box> box_of_site(const Settings& settings) const;
  void mark_far_from_site(Snapshot& snapshot) const;
  void mark_apart(Snapshot& snapshot);
  void mark_far_from_others(Snapshot& snapshot);

  std::int64_t least_ = 0;      // units of the mesh
  std::int64_t from_site_ = 0;  // the same; 0: nobody knows how long a unit is
  std::int64_t one_place_ = 0;  // the same
  std::optional<Box> site_;     // none: nothing is known of it that counts
  std::vector<std::int64_t> sorted_;
};

// The node that stands farthest from this one, or hardly less. REQUIRES: it is far from another.
const SnapshotVertex& farthest_from(const Snapshot& snapshot, const SnapshotVertex& vertex);

}  // namespace etcm::firmware
