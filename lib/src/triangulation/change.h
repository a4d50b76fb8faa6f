// A change of a mesh while it is going on: what it has spent, and what it must put right or take
// back. Nothing of it outlives the call that makes it.
#pragma once

#include "etcm/policy.h"
#include "triangulation/mesh_state.h"
#include "triangulation/segment_list.h"

namespace etcm::internal {

inline constexpr SegmentId end_of_group{static_cast<IdValue>(SegmentId::none_value - 2u)};

struct Change {
  enum class Extent : std::uint8_t {
    local,  // looks at the segments it has touched
    group,  // lays some segments as `whole` would, and prunes after each
    whole,  // lays all segments, and prunes after each
    trial,  // lays some segments otherwise, and may be taken back when it has been pruned
  };

  explicit Change(MeshState& state, Extent how_much = Extent::local) noexcept
      : mesh(state),
        extent(how_much),
        places_before(state.place_count),
        was_all_stale(state.is_all_stale),
        vertex_end_before(state.vertex_end),
        segment_end_before(state.segment_end) {
    state.error_detail = ErrorDetail{};
  }
  Change(const Change&) = delete;
  Change& operator=(const Change&) = delete;

  MeshState& mesh;
  DirtySegments dirty;
  SegmentId touched{};            // segments it has touched, linked by next_touched
  VertexId node{};                // that comes in it, or moves, once it is in
  VertexId detached{};            // vertices it has taken out, linked in place of their edges
  VertexId beside_detached{};     // that was beside the first of them, and stays
  SegmentId recycled_segments{};  // segments that features have left over, linked by next
  std::uint32_t touched_count = 0;
  std::uint32_t broken_count = 0;  // subsegments that it has broken, each time
  std::uint32_t fresh_count = 0;   // Steiner vertices that it has added
  Extent extent;
  // Extent::group: what is laid has an influence on a segment that has come to the group since: it
  // must be laid again with that one.
  bool has_grown = false;

  // Of MeshState, to be put back where the change is.
  const std::uint8_t places_before;
  const bool was_all_stale;
  const IdValue vertex_end_before;
  const IdValue segment_end_before;

  // The segment that is laid is lone (lone.h).
  SegmentId lone{};

  // Where it splits instead, what it draws from, and how many Steiner vertices are too many to go
  // on. By a pointer, so that only who makes trials links them.
  struct Trial {
    std::uint64_t random;
    Parameter (*stray)(Change& change, const SplitSite& site, Parameter t) noexcept;
    std::uint32_t steiner_most;
  };
  // The segments that are laid, linked by next_in_group up to end_of_group. Of the work on them,
  // before laying all segments is less: what is left, what of that is known to be needed, and what
  // is for a segment nothing is known of yet.
  struct Group {
    SegmentId first{};
    std::uint32_t work_left = 0;
    std::uint32_t work_ahead = 0;
    std::uint32_t work_of_member = 0;
  };
  // Of the extent of this name, and begun by it: the stack is deep.
  union {
    Trial trial;
    Group group{};
  };
};

// Vertex by vertex. Changes of other extents lay their segments again from the nodes on.
inline bool is_taken_back_whole(const Change& change) noexcept {
  return change.extent == Change::Extent::local || change.extent == Change::Extent::trial;
}
// The change may have to put the segment back: all of it, or from u to v. Where there is no room to
// look at what lies between them and what it has touched before, it is over.
void touch(Change& change, SegmentId s) noexcept;
void touch(Change& change, SegmentId s, VertexId u, VertexId v) noexcept;
// Nothing of the segment counts as touched any more, though it stays in the list.
inline void leave_untouched(MeshState& m, SegmentId s) noexcept {
  m.segment(s).first = infinite_vertex;
}
// The part of a segment in the list that is touched, in its direction, from a vertex that stays on
// to one that stays; both are infinite_vertex where nothing is.
struct TouchedPart {
  VertexId first;
  VertexId last;
};
inline TouchedPart touched_part(const MeshState& m, SegmentId s) noexcept {
  const SegmentRecord& r = m.segment(s);
  if (r.first.is_none()) return {r.from, r.to};
  return {r.first, r.first == infinite_vertex ? r.first : r.last};
}
// Its subsegments in the part that is touched may be missing.
void make_dirty(Change& change, SegmentId s) noexcept;
// Takes all segments off the list of touched ones.
void clear_touched(Change& change) noexcept;

}  // namespace etcm::internal
