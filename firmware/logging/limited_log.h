// A log that repeated noise does not flood: a line is written a few times, then ever more rarely,
// and what was left out is counted and told.
//
// Two bounds hold at a time. Of a kind (etcm/port/log.h: lines that differ in their details alone)
// lines_free lines are written in its first window. Of a pattern (lines that differ in any numbers:
// the same trouble, of whichever node or unit) it is pattern_lines_free, half of which are kept for
// kinds that have not been heard of: those that repeat cannot hide a new one. While some are left
// out, windows grow, each twice the one before, and have fewer lines. A window in which nothing was
// left out ends that. So a unit that comes and goes all night takes some twenty lines of each kind,
// whoever reads them sees each distinct problem, and ten thousand nodes that all move write no more
// than the bound of their pattern.
//
// Each line that was left out is in the count of one line that tells so.
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
  static constexpr std::uint32_t pattern_lines_free = 1000;
  static constexpr std::uint32_t pattern_lines_noisy = 100;
  static constexpr port::Duration first_window = std::chrono::minutes(15);
  static constexpr port::Duration longest_window = std::chrono::hours(1);
  // Kinds and patterns it can tell apart at a time. Of more kinds the bound of their pattern holds
  // alone; more patterns share one bound.
  static constexpr std::size_t kinds_max = 1024;
  static constexpr std::size_t patterns_max = 256;

  // Both must outlive the log. All the memory it ever needs is taken here.
  LimitedLog(port::Log& log, const port::Clock& clock);

  void write(port::Level level, std::string_view line) override;

  // Tells of all that was left out and not told yet.
  void flush();

 private:
  // What was written and left out of a kind or of a pattern.
  struct Record {
    std::uint64_t hash = 0;     // 0: free
    std::uint64_t pattern = 0;  // of a kind: the hash of its pattern
    port::Instant window_start{};
    port::Duration window{};
    port::Instant last{};
    std::uint32_t lines_left = 0;
    std::uint32_t lines_kept = 0;  // of these, for what is new
    std::uint32_t left_out = 0;
    port::Level level = port::Level::info;
    std::uint8_t sample_size = 0;
    bool is_sample_cut = false;
    std::array<char, 118> sample{};  // the last line left out, as far as it fits

    bool is_over(port::Instant now) const { return now - window_start >= window; }
    // It would be no different if it had never been.
    bool is_spent(port::Instant now) const { return left_out == 0 && is_over(now); }
    void begin_window(port::Instant now, bool was_noisy);
    bool take_line(bool is_new);
    void leave_out(std::string_view line, std::uint32_t count);
  };

  Record& pattern_of(std::uint64_t hash, port::Level level, port::Instant now);
  Record* kind_of(std::uint64_t hash, port::Instant now, bool& is_new);
  void end_pattern(Record& pattern, port::Instant now);
  void end_kind(Record& kind, port::Instant now);
  void tell_pattern(Record& pattern, port::Instant now);
  void tell_kind(Record& kind, port::Instant now);
  void tell(Record& record, const char* likeness, port::Instant now);
  void tell_some(port::Instant now);

  port::Log& log_;
  const port::Clock& clock_;
  std::vector<Record> kinds_;     // sets, by hash
  std::vector<Record> patterns_;  // the same, and behind them one for all that finds no place
  std::size_t next_kind_ = 0;     // to be looked at
  std::size_t next_pattern_ = 0;
};

}  // namespace etcm::firmware
