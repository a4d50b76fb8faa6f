// A log that repeated noise does not flood: each kind of line (etcm/port/log.h) is written a few
// times, then ever more rarely, and what was left out is counted and told.
//
// A kind may have lines_free lines in its first window. While some are left out, its windows grow,
// each twice the one before, and have one line. A window in which nothing was left out ends that.
// So a unit that comes and goes all night takes some twenty lines of each kind, and whoever reads
// them sees each distinct problem.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "etcm/port/clock.h"
#include "etcm/port/log.h"

namespace etcm::firmware {

class LimitedLog final : public port::Log {
 public:
  static constexpr std::uint32_t lines_free = 5;
  static constexpr port::Duration first_window = std::chrono::minutes(15);
  static constexpr port::Duration longest_window = std::chrono::hours(1);
  // Kinds it can tell apart at a time; of more, the longest silent are forgotten.
  static constexpr std::size_t kinds_max = 1024;

  // Both must outlive the log. All the memory it ever needs is taken here.
  LimitedLog(port::Log& log, const port::Clock& clock);

  void write(port::Level level, std::string_view line) override;

  // Tells of all that was left out and not told yet.
  void flush();

 private:
  struct Kind {
    std::uint64_t hash = 0;  // 0: free
    port::Instant window_start{};
    port::Duration window{};
    port::Instant last{};
    std::uint32_t lines_left = 0;
    std::uint32_t left_out = 0;
    port::Level level = port::Level::info;
    std::uint8_t sample_size = 0;
    std::array<char, 119> sample{};  // the last line left out, as far as it fits
  };

  Kind& kind_of(std::uint64_t hash, port::Instant now);
  void end_window(Kind& kind, port::Instant now);
  void tell(Kind& kind, port::Instant now);
  void tell_some(port::Instant now);

  port::Log& log_;
  const port::Clock& clock_;
  std::vector<Kind> kinds_;  // sets of kinds_per_set, by hash
  std::size_t next_told_ = 0;
};

}  // namespace etcm::firmware
