// Several features at once, each linked and conformed in canonical order.
#pragma once

#include "triangulation/mesh_state.h"

namespace etcm::internal {

// Links and conforms a list of features (linked by next_dirty), first those that need no Steiner
// vertex, then the others one by one, each in canonical order. Leaves the rest in `pending`.
Status conform_features(MeshState& m, SegmentId list, SegmentId& pending) noexcept;

}  // namespace etcm::internal
