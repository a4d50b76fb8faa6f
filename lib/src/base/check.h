// Assertions in two strengths. Neither is for what a caller can cause with data: that is a Status.
//
//   ETCM_CHECK(fact)        cheap and always on: a call that breaks the contract stops here.
//   ETCM_VERIFY_THAT(fact)  costly or redundant: only in builds with ETCM_VERIFY.
//
// A broken fact calls etcm_check_failed(), which must not return. The library's own traps; a
// program that wants to log or reset first defines a function of that name, and the linker takes
// it.
#pragma once

#include "base/plain.h"
#include "etcm/illegal_argument.h"

namespace etcm::internal {

[[noreturn, gnu::always_inline]] inline void fail_check(const char* what, const char* file,
                                                        int line) noexcept {
  plain(etcm_check_failed)(what, file, line);
  __builtin_unreachable();
}

}  // namespace etcm::internal

#define ETCM_CHECK(fact) \
  ((fact) ? void(0) : ::etcm::internal::fail_check(#fact, __FILE_NAME__, __LINE__))

#ifdef ETCM_VERIFY
#define ETCM_VERIFY_THAT(fact) ETCM_CHECK(fact)
#else
// sizeof: the fact must compile and counts as a use of its names, but is never evaluated.
#define ETCM_VERIFY_THAT(fact) (void(sizeof((fact) ? 1 : 0)))
#endif
