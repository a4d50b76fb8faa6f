// Segments near which there is nothing of any other feature: they get the fewest Steiner vertices
// that there can be.
#pragma once

#include "triangulation/change.h"

namespace etcm::internal {

// When a change of the extent `whole` or `group` has laid its segments: lays those again that are
// lone, and tells the policy so (SplitSite::is_lone). Not before: which are shows when all stand.
// Errors: those of lay_segments().
Status lay_lone_again(Change& change) noexcept;

}  // namespace etcm::internal
