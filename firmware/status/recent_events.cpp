#include "firmware/status/recent_events.h"

#include <algorithm>

namespace etcm::firmware {

RecentEvents::RecentEvents(const port::Clock& clock, port::Log& next)
    : clock_(clock), next_(next), kept_(recent_events_max) {}

void RecentEvents::write(port::Level level, std::string_view line) {
  next_.write(level, line);
  Kept& kept = kept_[place_of(written_++)];
  kept.at = clock_.now();
  kept.level = level;
  std::size_t size = std::min(line.size(), kept.text.size());
  // Not in the middle of a character of UTF-8.
  while (size < line.size() && size > 0 &&
         (static_cast<unsigned char>(line[size]) & 0xc0) == 0x80) {
    --size;
  }
  kept.size = static_cast<std::uint16_t>(size);
  std::copy_n(line.begin(), size, kept.text.begin());
}

std::uint32_t RecentEvents::count() const {
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(written_, recent_events_max));
}

RecentEvent RecentEvents::at(std::uint32_t index) const {
  const std::uint64_t number = written_ - count() + index;
  const Kept& kept = kept_[place_of(number)];
  return {.number = number + 1,
          .at = kept.at,
          .level = kept.level,
          .text = {kept.text.data(), kept.size}};
}

}  // namespace etcm::firmware
