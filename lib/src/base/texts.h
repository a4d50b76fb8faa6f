// Names for people, which no program has to carry that does not ask for them.
//
// They stand one behind the other in one array, which a linker leaves out as a whole. Literals of
// their own would stay where any of their source is used, and all are of one source where the
// library is taken in as one (tools/drop_in).
#pragma once

#include <cstddef>

namespace etcm::internal {

// How many texts stand in an array, each with its 0.
template <std::size_t Size>
constexpr std::size_t text_count(const char (&texts)[Size]) noexcept {
  std::size_t count = 0;
  for (const char letter : texts) count += letter == '\0' ? 1 : 0;
  return count;
}

// The n-th of them, from 0; of what has no text of its own the last that there is.
inline const char* nth_text(const char* texts, std::size_t n, std::size_t last) noexcept {
  for (std::size_t left = n < last ? n : last; left != 0; --left) {
    while (*texts != '\0') ++texts;
    ++texts;
  }
  return texts;
}

}  // namespace etcm::internal
