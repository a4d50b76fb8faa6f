// Segments that are laid again together, so that the mesh becomes the one that build() makes.
#pragma once

#include "triangulation/change.h"

namespace etcm::internal {

// What laying all segments takes at least, and with it going back from there.
Units work_to_lay_all(const MeshState& m) noexcept;
// To list a segment or a vertex a few times.
inline constexpr std::uint32_t work_of_listing = 24;

// Lays a stale segment again, and with it every segment that it can have had, or has now, an
// influence on, and so on: none is left then on which one of the group has any, so none of the
// others would be laid otherwise. The change is of the extent `group`, and is ended where the
// answer is ok or an error (then nothing has changed). `is_too_wide`: that would be a large part of
// the mesh; all must be laid, and the change is of the extent `whole`, its Steiner vertices
// detached or fresh as they are.
Status lay_group_again(Change& change, SegmentId stale, bool& is_too_wide) noexcept;

// Whether a Steiner vertex that has come has an influence on the group alone. Else the group has
// grown, and what is being laid is given up.
bool stays_in_group(Change& change, VertexId v) noexcept;

}  // namespace etcm::internal
