// A command that somebody sends to an edge node of Sparkplug.
#include "firmware/sparkplug/payload.h"
#include "fuzz_target.h"

namespace etcm::fuzz {

void run(std::span<const std::uint8_t> bytes) {
  static_cast<void>(firmware::sparkplug::asks_for_rebirth(text_of(bytes)));
}

}  // namespace etcm::fuzz
