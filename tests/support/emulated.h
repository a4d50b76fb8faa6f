// How much of a long test to do where everything takes ten to thirty times as long: under an
// emulator and under AddressSanitizer.
#pragma once

#include "support/sanitized.h"

namespace etcm::test {

// Of what is random or exhaustive, one part in so many. All of it is done by the preset release, on
// the same source (tests/README.md says when); and that another machine's meshes are the same, bit
// for bit, is asked of the whole corpus (property/corpus_same_bits_as_host).
#ifdef ETCM_EMULATED
inline constexpr bool is_emulated = true;
#else
inline constexpr bool is_emulated = false;
#endif
inline constexpr bool is_slow = is_emulated || is_address_sanitized;
inline constexpr int thinning_if_slow = is_slow ? 10 : 1;
// Of the gateway's parts, which CI passes under sanitizers alone, and so all of it there.
inline constexpr int thinning_if_emulated = is_emulated ? 10 : 1;

}  // namespace etcm::test
