// Makes segments unions of edges.
#pragma once

#include "triangulation/change.h"
#include "triangulation/march.h"

namespace etcm::internal {

// Works off the dirty segments, splitting as config.policy says, until every touched segment is a
// union of edges. Errors: the room-and-bounds codes, crossing_features; error_detail is set.
Status conform(Change& change) noexcept;
// True where the subsegment can be an edge by choosing among ties (or is one).
bool can_be_edge(const MeshState& m, const Subsegment& subsegment) noexcept;
// Makes a subsegment that can be an edge a marked edge. False: there is no room for the work on its
// ties, and nothing is changed.
[[nodiscard]] bool constrain_subsegment(MeshState& m, const Subsegment& subsegment) noexcept;
// Once conform() has given up: marks the subsegments of dirty segments that can be edges, and
// counts the others. Where there is no room for the work it is over.
std::uint32_t constrain_rest(Change& change) noexcept;

}  // namespace etcm::internal
