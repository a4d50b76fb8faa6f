#include "fuzz_target.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace etcm::fuzz {

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", what);
  std::abort();
}

std::uint8_t Input::byte() {
  if (bytes_.empty()) return 0;
  const std::uint8_t first = bytes_.front();
  bytes_ = bytes_.subspan(1);
  return first;
}

std::uint16_t Input::word() {
  const std::uint8_t low = byte();
  return static_cast<std::uint16_t>(low | byte() << 8);
}

std::uint32_t Input::number() {
  const std::uint32_t low = word();
  return low | static_cast<std::uint32_t>(word()) << 16;
}

std::uint32_t Input::below(std::uint32_t end) { return end <= 256 ? byte() % end : word() % end; }

std::span<const std::uint8_t> Input::take(std::size_t most) {
  const auto taken = bytes_.first(std::min(most, bytes_.size()));
  bytes_ = bytes_.subspan(taken.size());
  return taken;
}

}  // namespace etcm::fuzz
