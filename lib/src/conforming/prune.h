// Steiner vertices whose cause has gone.
#pragma once

#include "triangulation/change.h"

namespace etcm::internal {

// Takes out the Steiner vertices of the touched segments without which their feature still is a
// union of Delaunay edges, and those of other segments that become needless by that. Never breaks a
// thing. False: the limit of the work does not allow it, and the change has to be taken back; what
// has been taken out and was not fresh is detached.
[[nodiscard]] bool prune(Change& change) noexcept;

}  // namespace etcm::internal
