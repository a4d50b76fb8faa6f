// How much of a long test to do under an emulator, where everything takes thirty times as long, and
// under AddressSanitizer, where it takes ten times.
#pragma once

#include "support/sanitized.h"

namespace etcm::test {

// Of what is random or exhaustive, one part in so many. All of it is done on the machine that
// builds, on the same source; and that the other machine's meshes are the same, bit for bit, is
// asked of the whole corpus (property/corpus_same_bits_as_host).
#ifdef ETCM_EMULATED
inline constexpr int thinning_if_slow = 10;
inline constexpr bool is_emulated = true;
#else
inline constexpr int thinning_if_slow = is_address_sanitized ? 3 : 1;
inline constexpr bool is_emulated = false;
#endif

}  // namespace etcm::test
