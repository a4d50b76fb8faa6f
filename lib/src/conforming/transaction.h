// The end of a change: all of it stays, or none.
#pragma once

#include "triangulation/change.h"

namespace etcm::internal {

// The change is taken back from here on, because of `status`. Drops what is fresh.
void begin_going_back(Change& change, Status status) noexcept;
// Puts a vertex back where it stood.
void put_back(Change& change, VertexId v) noexcept;
// Puts the detached vertices back, marks all touched segments anew and ends the change, its new ids
// forgotten. The segment records must be those of before, and the fresh vertices dropped.
void restore_detached(Change& change) noexcept;
// Takes ids that were new in the change, all of them free again, for never used.
void forget_new_ids(Change& change) noexcept;
// Once the change is pruned: all of it stays, and is ended.
void settle(Change& change) noexcept;
// Prunes needless Steiner vertices of the touched segments, and ends the change. Error: work_limit,
// and the change has to be taken back; so has a dry run, whose outcome is known then.
[[nodiscard]] Status commit(Change& change) noexcept;
// Forgets the change: what came has come, what was retired and not used again becomes free.
// Whatever a change ends with ends with this, or the next one would take back what was this one's.
void end_change(Change& change) noexcept;

}  // namespace etcm::internal
