// Several files in the bytes of one input, and a folder for them.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "fuzz_target.h"
#include "support/scratch_folder.h"

namespace etcm::fuzz {

// Stands between two files (ASCII's record separator): no text has it.
inline constexpr char part_end = '\x1e';

// The bytes up to the next part_end, which is taken too.
inline std::string take_part(std::string_view& text) {
  const std::size_t end = std::min(text.find(part_end), text.size());
  const std::string part(text.substr(0, end));
  text.remove_prefix(std::min(end + 1, text.size()));
  return part;
}

// One for all inputs, which write each file that they read.
inline const test::ScratchFolder& scratch() {
  static const test::ScratchFolder folder;
  return folder;
}

}  // namespace etcm::fuzz
