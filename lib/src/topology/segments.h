// Features as the mesh keeps them: a feature is a chain of segments, one for each segment between
// neighbouring nodes on it, each with a parameter grid of its own (policy.h). Knows no coordinates.
#pragma once

#include <limits>

#include "etcm/types.h"

namespace etcm::internal {

// A segment is named by its place; the first segment of a feature has the feature's id.
using SegmentId = Id<struct SegmentTag>;

struct SegmentRecord {
  VertexId from;  // lexicographically before `to`; none: the place is free
  VertexId to;
  // The incidence list of each end, and the next segment of the feature, from -> to. In a free
  // place these three words hold what FreeIds needs.
  SegmentId next_at_from;
  SegmentId next_at_to;
  SegmentId next;
  IdValue root;  // the feature's first segment, with reversed_bit
  // For the change that is going on: the list the segment is in (segment_list.h) and that of those
  // it has touched, or not_listed; and the vertices between which it has, or none for everywhere.
  SegmentId next_listed;
  SegmentId next_touched;
  VertexId first;
  VertexId last;
  // Whether the segment is as build() makes it: not_listed. Else it is stale, and while a group of
  // segments is laid again the next one of the group, or none (canonical.h, lay_again.h).
  SegmentId next_in_group;
  SegmentId next_dependent;  // the ring of the segments that depend on each other
};

// In `root`: the user gave the feature from its lexicographically greater end.
inline constexpr IdValue reversed_bit =
    static_cast<IdValue>(IdValue{1} << (std::numeric_limits<IdValue>::digits - 1));

// The root of a place that no feature has.
inline constexpr IdValue free_root = std::numeric_limits<IdValue>::max();

inline constexpr SegmentId not_listed{static_cast<IdValue>(SegmentId::none_value - 1u)};

// What a vertex is, and the segment it belongs to: for a node the head of its incidence list, for a
// Steiner vertex the segment it stands on. One word.
enum class Role : std::uint8_t {
  free,
  node,
  steiner,
  fresh,     // a Steiner vertex that the running change has added
  detached,  // out of the mesh, but back in it if the running change fails
};

constexpr bool is_in_mesh(Role role) noexcept {
  return role == Role::node || role == Role::steiner || role == Role::fresh;
}

class Owner {
 public:
  constexpr Owner() noexcept = default;
  constexpr Owner(Role role, SegmentId segment) noexcept
      : word_(static_cast<IdValue>((static_cast<IdValue>(role) << shift) |
                                   (segment.value & index_mask))) {}
  constexpr Role role() const noexcept { return static_cast<Role>(word_ >> shift); }
  constexpr SegmentId segment() const noexcept {
    const IdValue index = word_ & index_mask;
    return index == index_mask ? SegmentId::none() : SegmentId{index};
  }

 private:
  static constexpr int shift = std::numeric_limits<IdValue>::digits - 3;
  static constexpr IdValue index_mask = static_cast<IdValue>((IdValue{1} << shift) - 1u);
  IdValue word_ = index_mask;
};

}  // namespace etcm::internal
