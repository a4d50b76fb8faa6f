#include <cstdio>

#include "link.h"

namespace etcm::bus {

void FrameDisplay::show(std::span<const std::uint8_t> bytes, char before, char behind) const {
  if (!is_shown_ || bytes.empty()) return;
  for (const std::uint8_t byte : bytes) std::fprintf(stderr, "%c%02X%c", before, byte, behind);
  std::fputc('\n', stderr);
}

}  // namespace etcm::bus
