// Features as the mesh keeps them: a feature is a run of sections, one for each stretch between
// neighbouring nodes on it, each with a parameter grid of its own (policy.h). Knows no coordinates.
#pragma once

#include <limits>

#include "etcm/types.h"

namespace etcm::internal {

// A section is named by its place; the first section of a feature has the feature's id.
using SectionId = Id<struct SectionTag>;

struct SectionRecord {
  VertexId from;  // lexicographically before `to`; none: the place is free
  VertexId to;
  SectionId next_at_from;  // the incidence list of each end
  SectionId next_at_to;
  SectionId next;          // the next section of the feature, from -> to; free places: the next one
  IdValue root;            // the feature's first section, with reversed_bit
  SectionId next_dirty;    // the list of sections with missing pieces, or not_listed
  SectionId next_touched;  // the list of sections the running change has touched, or not_listed
  // The vertices between which the running change has touched it; none: everywhere.
  VertexId first;
  VertexId last;
};

// In `root`: the user gave the feature from its lexicographically greater end.
inline constexpr IdValue reversed_bit =
    static_cast<IdValue>(IdValue{1} << (std::numeric_limits<IdValue>::digits - 1));

// The root of a place that no feature has.
inline constexpr IdValue free_root = std::numeric_limits<IdValue>::max();

inline constexpr SectionId not_listed{static_cast<IdValue>(SectionId::none_value - 1u)};

// What a vertex is, and the section it belongs to: for a node the head of its incidence list, for a
// Steiner vertex the section it stands on. One word.
enum class Role : std::uint8_t {
  free,
  node,
  steiner,
  fresh,     // a Steiner vertex that the running change has added
  detached,  // out of the mesh, but back in it if the running change fails
};

class Owner {
 public:
  constexpr Owner() noexcept = default;
  constexpr Owner(Role role, SectionId section) noexcept
      : word_(static_cast<IdValue>((static_cast<IdValue>(role) << shift) |
                                   (section.value & index_mask))) {}
  constexpr Role role() const noexcept { return static_cast<Role>(word_ >> shift); }
  constexpr SectionId section() const noexcept {
    const IdValue index = word_ & index_mask;
    return index == index_mask ? SectionId::none() : SectionId{index};
  }

 private:
  static constexpr int shift = std::numeric_limits<IdValue>::digits - 3;
  static constexpr IdValue index_mask = static_cast<IdValue>((IdValue{1} << shift) - 1u);
  IdValue word_ = index_mask;
};

}  // namespace etcm::internal
