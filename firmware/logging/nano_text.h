// A decimal as a text.
#pragma once

#include <cstdint>
#include <string>

#include "etcm/files/decimal.h"
#include "firmware/logging/text_line.h"

namespace etcm::firmware {

// What is in 10^-9, every digit that is no zero at the end: "10.394".
inline std::string nano_text(std::int64_t count) {
  TextLine text;
  files::write_nano(text, count);
  return std::string(std::string_view(text));
}

}  // namespace etcm::firmware
