// The latest lines of the log, kept for the status page.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "etcm/port/clock.h"
#include "etcm/port/log.h"
#include "firmware/status/document.h"

namespace etcm::firmware {

inline constexpr std::uint32_t recent_events_max = 100;

struct RecentEvent {
  std::uint64_t number = 0;  // from 1, in the order in which they came
  port::Instant at{};
  port::Level level = port::Level::info;
  std::string_view
      text;  // its beginning with "…", where it is very long; good until the next is written
};

// "info", "warning" or "error".
const char* word_of(port::Level level);

// Hands each line on, and remembers the last recent_events_max. No memory is taken after it is
// made.
class RecentEvents final : public port::Log {
 public:
  // Both must outlive this.
  RecentEvents(const port::Clock& clock, port::Log& next);

  void write(port::Level level, std::string_view line) override;

  // How many there are; the oldest is number 0.
  std::uint32_t count() const;
  RecentEvent at(std::uint32_t index) const;
  std::uint64_t written() const { return written_; }

 private:
  struct Kept {
    port::Instant at{};
    port::Level level = port::Level::info;
    std::uint16_t size = 0;
    std::array<char, 400> text;
  };

  // In the ring.
  static std::size_t place_of(std::uint64_t number) {
    return static_cast<std::size_t>(number % recent_events_max);
  }

  const port::Clock& clock_;
  port::Log& next_;
  std::vector<Kept> kept_;  // a ring
  std::uint64_t written_ = 0;
};

// The next one after what the cursor has, the newest first; none: there are no more. New ones may
// come meanwhile, which are left out, and then the oldest are gone.
std::optional<RecentEvent> next_event(const RecentEvents& events, Cursor& cursor);

}  // namespace etcm::firmware
