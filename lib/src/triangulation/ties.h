// Which of the triangulations of cocircular points is the canonical one.
#pragma once

#include "triangulation/march.h"
#include "triangulation/mesh_state.h"

namespace etcm::internal {

// What it takes at most to bring what is beside a chord of an empty circle to its canonical form,
// for each corner.
inline constexpr Units work_of_chord = 18;

// Makes a subsegment a marked edge that is one, or crosses edges all of whose ends lie on one empty
// circle with it, and brings the ties beside it to their canonical form. Beforehand there must be
// room for that, and for the reverse, but where a change is taken back: it has been kept. False:
// there is none, and nothing must be touched.
[[nodiscard]] bool may_constrain(MeshState& m, const Subsegment& subsegment) noexcept;
void constrain(MeshState& m, const Subsegment& subsegment) noexcept;
// The reverse: takes the mark off an edge.
[[nodiscard]] bool may_release(MeshState& m, Edge e) noexcept;
void release_constraint(MeshState& m, Edge e) noexcept;

}  // namespace etcm::internal
