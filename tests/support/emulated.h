// How much of a long test to do under an emulator, where everything takes thirty times as long.
#pragma once

namespace etcm::test {

// Of what is random or exhaustive, one part in so many. All of it is done on the machine that
// builds, on the same source; and that the other machine's meshes are the same, bit for bit, is
// asked of the whole corpus (property/corpus_same_bits_as_host).
#ifdef ETCM_EMULATED
inline constexpr int thinning_if_emulated = 10;
#else
inline constexpr int thinning_if_emulated = 1;
#endif
inline constexpr bool is_emulated = thinning_if_emulated > 1;

}  // namespace etcm::test
