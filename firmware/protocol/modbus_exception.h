// What a unit means by an exception, in words for whoever looks after it.
#pragma once

#include <cstdint>

namespace etcm::firmware {

struct ExceptionText {
  const char* meaning;  // behind "exception 2: "
  const char* cure;
};

// Of an answer to a read. `is_node`: of a unit whose registers are ours; else a profile says which
// are read.
ExceptionText explain_exception(std::uint8_t code, bool is_node);

}  // namespace etcm::firmware
