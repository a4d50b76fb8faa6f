// Checks of what a public call is given (etcm/illegal_argument.h).
#pragma once

#include "base/plain.h"
#include "etcm/illegal_argument.h"

namespace etcm::internal {

// Stops the program unless the argument is legal. Inline wherever it is asked for: what is legal
// then costs a comparison and nothing is saved for a call that does not come.
[[gnu::always_inline]] inline void demand([[maybe_unused]] bool is_legal,
                                          [[maybe_unused]] Call call,
                                          [[maybe_unused]] Fault fault) noexcept {
#ifdef ETCM_CHECK_ARGUMENTS
  if (is_legal) return;
  plain(etcm_illegal_argument)(call, fault);
  __builtin_unreachable();
#endif
}

}  // namespace etcm::internal
