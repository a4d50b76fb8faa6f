// The end of a change: all of it stays, or none.
#pragma once

#include "triangulation/change.h"

namespace etcm::internal {

// Puts the detached vertices back, marks all touched segments anew and ends the change, its new ids
// forgotten. The segment records must be those of before, and the fresh vertices dropped.
void restore_detached(Change& change) noexcept;
// They do not come back.
void free_detached(Change& change) noexcept;
// Takes ids that were new in the change, all of them free again, for never used.
void forget_new_ids(Change& change) noexcept;
// Prunes needless Steiner vertices of the touched segments, and ends the change.
void commit(Change& change) noexcept;
// Forgets the change: what came has come, what was retired and not used again becomes free.
// Whatever a change ends with ends with this, or the next one would take back what was this one's.
void end_change(Change& change) noexcept;

}  // namespace etcm::internal
