#include "firmware/status/recent_events.h"

#include <algorithm>

#include "etcm/port/utf8.h"

namespace etcm::firmware {

namespace {

constexpr std::string_view ellipsis = "\u2026";

}  // namespace

RecentEvents::RecentEvents(const port::Clock& clock, port::Log& next)
    : clock_(clock), next_(next), kept_(recent_events_max) {}

void RecentEvents::write(port::Level level, std::string_view line) {
  next_.write(level, line);
  if (level == port::Level::detail) return;
  Kept& kept = kept_[place_of(written_++)];
  kept.at = clock_.now();
  kept.level = level;
  const bool is_whole = line.size() <= kept.text.size();
  const std::string_view fits =
      is_whole ? line : port::cut_words(line, kept.text.size() - ellipsis.size());
  auto end = std::copy(fits.begin(), fits.end(), kept.text.begin());
  if (!is_whole) end = std::copy(ellipsis.begin(), ellipsis.end(), end);
  kept.size = static_cast<std::uint16_t>(end - kept.text.begin());
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

// `part` is how many had come when the first was taken, `item` how many are taken.
std::optional<RecentEvent> next_event(const RecentEvents& events, Cursor& cursor) {
  if (cursor.item == 0) cursor.part = static_cast<std::uint32_t>(events.written());
  const std::uint64_t number = std::uint64_t{cursor.part} - cursor.item;
  const std::uint64_t oldest = events.written() - events.count();
  if (cursor.item >= cursor.part || number <= oldest) return std::nullopt;
  ++cursor.item;
  return events.at(static_cast<std::uint32_t>(number - 1 - oldest));
}

const char* word_of(port::Level level) {
  switch (level) {
    case port::Level::error:
      return "error";
    case port::Level::warning:
      return "warning";
    case port::Level::info:
    case port::Level::detail:
      break;
  }
  return "info";
}

}  // namespace etcm::firmware
