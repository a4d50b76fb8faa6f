// For each node of a published mesh the nodes that stand around it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "firmware/publish/snapshot.h"

namespace etcm::firmware {

inline constexpr std::size_t nearest_nodes_max = 24;

// Where a node stands, seen from the one that is asked about.
struct NearNode {
  std::uint32_t row = 0;  // of the snapshot
  double x = 0;           // in units of the site
  double y = 0;
};

// Candidates are the nodes within two edges of a node. A Steiner vertex counts as if it were not
// there: behind it are the two nodes at the ends of its segment, and the nodes that edges join to
// it. Anchors are nodes here; whoever has no reading of one leaves it out.
class NearestNodes {
 public:
  // All the memory it needs is taken here: 20 bytes a vertex, and 0.6 KB for each of the nodes that
  // are asked about, so many at the most. At most vertices_max rows are looked at.
  NearestNodes(std::uint32_t vertices_max, std::uint32_t nodes_max);
  // More of them.
  void set_room(std::uint32_t nodes_max);

  // Another generation, and the rows that are asked about: nodes_max at the most, the others are
  // left out. O(n): of a vertex with many edges 64, evenly spread, are looked at, so a node costs
  // at most 30 000 looks, and some 100 in meshes that are no adversary's.
  void take(const Snapshot& snapshot, std::span<const std::uint32_t> rows);

  std::uint32_t row_count() const { return row_count_; }
  // The nearest first; of equally near ones the lower row. Empty for a row that was not asked
  // about, or is no node. Good until take().
  std::span<const NearNode> around(std::uint32_t row) const;

 private:
  struct Ends {
    std::uint32_t first = no_row;
    std::uint32_t second = no_row;
  };

  void find_ends(const Snapshot& snapshot);
  void begin_search(const Snapshot& snapshot, std::uint32_t centre);
  void add(const Snapshot& snapshot, std::uint32_t row);
  void add_neighbours(const Snapshot& snapshot, std::uint32_t row);

  static constexpr std::uint32_t no_place = 0xffffffff;

  std::vector<std::uint32_t> place_of_;  // by row: among those that are asked about
  std::vector<NearNode> near_;           // nearest_nodes_max a place
  std::vector<std::uint8_t> count_;      // of them, by place
  std::vector<Ends> ends_;               // of the segment of a Steiner vertex, by row
  std::vector<std::uint32_t> seen_;      // by row: the search that met it last
  std::uint32_t row_count_ = 0;

  // The search under way.
  std::uint32_t search_ = 0;
  Point centre_;
  std::array<NearNode, nearest_nodes_max> found_{};
  std::size_t found_count_ = 0;
};

}  // namespace etcm::firmware
